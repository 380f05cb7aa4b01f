# %% [markdown]
# # Is my MuJoCo cable right?
#
# A cable of MuJoCo's plugin `mujoco.elasticity.cable` is a chain of bodies. What it needs is an
# array of shape (M, 3) in metres: `data.xpos` of all its bodies, the last included, and behind them
# the end of the last body. Here a chain of 30 points stands in for it, with a Young's modulus of
# which somebody has mistyped the exponent.

# %%
import numpy

import dlo

cable = dlo.Scene(
    length="1 m",
    diameter="8 mm",
    material={"youngs_modulus": "120 MPa", "density": 1150},
    grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="0 deg")],
)
mistyped = cable.replace(
    material={"youngs_modulus": "12 MPa", "density": 1150}, force_model={"points": 30}
)
xpos = dlo.solve(mistyped, model="chain").points  # yours: data.xpos of the bodies, and the end of the last one

# %% [markdown]
# `check` compares them with the shape that the material would take, and prints the most likely cause of a difference.

# %%
check = dlo.check(cable, xpos, tolerance="1%")
print("passed" if check.passed else "failed", f"{100 * check.rms / cable.length:.2g} % of the length off")
print(f"E*/E = {check.modulus_ratio:.3g}")
print("best explanation:", check.explanations[0][0])
assert not check.passed
assert numpy.isclose(check.modulus_ratio, 0.1, rtol=0.05)

# %% [markdown]
# With the right modulus what is left is what a chain of 30 points costs.

# %%
right = dlo.solve(cable.replace(force_model={"points": 30}), model="chain").points
check = dlo.check(cable, right, tolerance="1%")
print("passed" if check.passed else "failed", f"{100 * check.rms / cable.length:.2g} % of the length off")
assert check.passed
