# %% [markdown]
# # E of a photographed cable
#
# A cable is clamped level and hangs down before a wall with a ruler. Thirty points along it are read
# off the picture, in metres, x to the right and y up. Here they are made: the exact shape at 20 MPa,
# with 1 mm of noise in each coordinate.

# %%
import numpy

import dlo

scene = dlo.Scene(
    length="80 cm",
    diameter="5 mm",
    material={"youngs_modulus": "5 MPa", "density": 1300},  # a first guess
    grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="0 deg")],
)
truth = scene.replace(material={"youngs_modulus": "20 MPa", "density": 1300})
random = numpy.random.default_rng(1)
picture = dlo.solve(truth, model="exact", samples=30).points[:, :2] + random.normal(0, 1e-3, (30, 2))

# %%
fit = dlo.calibrate(scene, [picture])
low, high = fit.interval
print(f"E = {fit.youngs_modulus / 1e6:.3g} MPa, 95 % interval {low / 1e6:.3g} to {high / 1e6:.3g} MPa")
assert low < 20e6 < high

# %% [markdown]
# A camera that was not held level: its picture is rotated by an angle that nobody knows, and only the
# points' distances count. The interval gets wider, as it should.

# %%
turn = numpy.radians(4)
rotation = numpy.array([[numpy.cos(turn), -numpy.sin(turn)], [numpy.sin(turn), numpy.cos(turn)]])
oblique = dlo.calibrate(scene, [picture @ rotation.T + [0.1, 0.2]], register="rigid")
low_oblique, high_oblique = oblique.interval
print(f"E = {oblique.youngs_modulus / 1e6:.3g} MPa, {low_oblique / 1e6:.3g} to {high_oblique / 1e6:.3g} MPa")
assert low_oblique < 20e6 < high_oblique
