#!/usr/bin/env node
// A scene as MuJoCo solves it, for dlo bench and dlo regress (compare/doc/protocol.md).
//
//     mujoco.mjs SCENE SHAPE [MODEL.XML]
//
// SCENE is what `dlo scene --format json` writes, SHAPE becomes a CSV file of the rod's axis; MODEL.XML, where it is
// named, what MuJoCo was given. Needs MuJoCo as WebAssembly: `npm install` in this folder.
//
// Bodies are the segments of the scene's `force_model`, with ball joints of stiffness EI/h at its hinges; the first
// segment is held, a second clamp is an equality constraint (weld) of the last. Only the shape at rest is asked for, which
// inertia has no part in: a hinge has that of its stiffness (armature), with which all hinges swing in the same time and
// steps to rest hardly grow with N, bodies have next to none, weight is a force on the points, and motion is stopped
// whenever it has lost speed. A ball joint's spring turns back along the rotation vector with one stiffness for bending
// and twist: for a rod with GJ < EI a hinge about the segment lies in series with it.

import { readFileSync, writeFileSync } from 'node:fs';

const STEPS = 1e5;
const AT_REST = 1e-13; // turn within a step [rad], at the moment of the highest speed

const fail = (why) => {
  console.error(`mujoco.mjs: ${why}`);
  process.exit(1);
};
/** Ends with exit status 3, which means that the scene is not supported. */
const refuse = (why) => {
  console.error(`mujoco.mjs: not supported: ${why}`);
  process.exit(3);
};
const minus = (a, b) => a.map((x, i) => x - b[i]);
const cross = (a, b) => [0, 1, 2].map((i) => a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const product = ([w, ...v], [u, ...r]) => {
  const c = cross(v, r);
  return [w * u - dot(v, r), ...v.map((x, i) => w * r[i] + u * x + c[i])];
};
const inverse = ([w, x, y, z]) => [w, -x, -y, -z];
/** Returns the shortest rotation from direction a to direction b, which are not opposite. */
const shortestTurn = (a, b) => {
  const scale = Math.hypot(...a) * Math.hypot(...b);
  const w = Math.sqrt((1 + dot(a, b) / scale) / 2);
  return [w, ...cross(a, b).map((x) => x / (2 * w * scale))];
};

function readChain(scene) {
  const { force_model: model, grippers, rod } = scene;
  const [first, second] = grippers;
  if (scene.motion) refuse('motion');
  if (grippers.length > 2 || grippers.some((grip) => grip.hold !== 'clamp') || first.at_m !== 0 ||
      (second && (second.at_m !== rod.length_m || minus(second.direction, first.direction).some((x) => x))))
    refuse('other than a clamp at arc length 0, and a second one, parallel to it, at the end');
  if (rod.natural_curvature_per_m.length || scene.obstacles.length) refuse('natural curvature, obstacles');
  if (rod.bending_stiffness_Nm2[0] !== rod.bending_stiffness_Nm2[1] || scene.loads.some((load) => load.torque_Nm))
    refuse('two bending stiffnesses, couples');
  if (model.refused) refuse(model.refused);
  const roll = second?.frame ? second.frame.roll_rad - first.frame.roll_rad : 0;
  const [EI, GJ] = [rod.bending_stiffness_Nm2[0], rod.torsional_stiffness_Nm2 ?? rod.bending_stiffness_Nm2[0]];
  if (roll && (rod.sections.length || GJ > EI)) refuse('twist other than of a rod without sections, with GJ <= EI');
  // The frame that does not twist along the polygon, and then the twist spread evenly.
  const start = model.start_m;
  let along = first.direction;
  let frame = shortestTurn([1, 0, 0], along);
  const frames = model.segment_m.map((_, i) => {
    const next = minus(start[i + 1], start[i]);
    frame = product(shortestTurn(along, next), frame);
    along = next;
    const half = (roll / 2) * (i / (model.segment_m.length - 1));
    return product(frame, [Math.cos(half), Math.sin(half), 0, 0]);
  });
  // Shapes at rest depend on forces over stiffnesses alone. MuJoCo takes no mass below 1e-15 kg.
  const unit = Math.min(...model.joint_stiffness_Nm);
  const hinges = model.joint_stiffness_Nm.map((stiffness) => ({
    bend: stiffness / unit,
    series: roll && GJ < EI ? (stiffness / unit) * (GJ / (EI - GJ)) : 0, // 1 / (EI/h) + 1 / series = 1 / (GJ/h)
  }));
  const force = model.point_force_N.map((one) => one.map((x) => x / unit));
  return { at: model.point_at_m, segment: model.segment_m, force, frames, hinges,
    hinge: model.held[0].points_m[1], lastHinge: second && model.held[1].points_m[0],
    origin: first.position_m, end: second?.position_m, length: rod.length_m };
}

/** Returns a quarter of the stability limit 2 / omega of the fastest motion [s]. omega^2 is at most 1 / s^2 from the
 * springs plus a bound of the contribution of the weight. */
function timeStep({ hinges, force, segment: [h] }) {
  // Turns of the hinges j and k move a point beyond both by its distance from the farther one.
  const weight = force.reduce((sum, one, i) => sum + (Math.hypot(...one) * h * i * (i + 1)) / 2, 0);
  return 0.5 / Math.sqrt(1 + weight);
}

function mjcf(chain) {
  const list = (numbers) => numbers.join(' ');
  // Of the bodies themselves, too little to matter beside the hinges'.
  const mass = 1e-4 / (chain.length * chain.hinges.length) ** 2;
  const inertia = mass * chain.segment[0] ** 2;
  // Written straight, since springs are at rest where the model is written, and turned afterwards.
  const bodies = chain.hinges.map(({ bend, series }, i) => `
    <body name="segment${i + 1}" pos="${list(i === 0 ? chain.hinge : [chain.segment[i], 0, 0])}"
        quat="${list(i === 0 ? chain.frames[0] : [1, 0, 0, 0])}">
      ${series ? `<joint type="hinge" axis="1 0 0" stiffness="${series}" armature="${series}"/>` : ''}
      <joint type="ball" stiffness="${bend}" armature="${bend}"/>
      <inertial pos="${chain.segment[i + 1]} 0 0" mass="${mass}" diaginertia="${list([inertia, inertia, inertia])}"/>`);
  const weld = `<equality>
    <weld body1="world" body2="segment${bodies.length}" anchor="0 0 0" solimp="0.9999 0.9999 0.001"
        relpose="${list([...(chain.lastHinge ?? []), ...chain.frames.at(-1)])}"/>
  </equality>`;
  return `<mujoco>
  <option timestep="${timeStep(chain)}" gravity="0 0 0" iterations="2" tolerance="1e-15"><flag contact="disable"/></option>
  <worldbody>${bodies.join('')}${'</body>'.repeat(bodies.length)}
  </worldbody>
  ${chain.end ? weld : ''}
</mujoco>
`;
}

/** Returns the positions at rest of the hinges and of the end of the last segment, beginning with the first hinge. */
function solve(mujoco, chain, xml) {
  const model = mujoco.MjModel.from_xml_string(xml);
  const data = new mujoco.MjData(model);
  const { qpos, qvel, xfrc_applied: applied } = data;
  let at = 0;
  chain.hinges.forEach(({ series }, i) => {
    at += series ? 1 : 0;
    qpos.set(product(inverse(chain.frames[i]), chain.frames[i + 1]), at);
    at += 4;
    applied.set(chain.force[i + 2], 6 * (i + 1)); // at the body's centre of mass, which is its end
  });
  // A weld yields to its force. Where it is led is moved by how far it is off, until it is not.
  const last = chain.hinges.length;
  const place = model.eq_data.subarray(3, 6), turn = model.eq_data.subarray(6, 10);
  const shiftWeld = () => {
    mujoco.mj_kinematics(model, data);
    const off = minus(chain.lastHinge, [...data.xpos.subarray(3 * last, 3 * last + 3)]);
    const turned = product(chain.frames.at(-1), inverse([...data.xquat.subarray(4 * last, 4 * last + 4)]));
    place.set(off.map((x, i) => place[i] + x));
    turn.set(product(turned, [...turn]));
  };
  const step = timeStep(chain);
  for (let i = 0, before = 0, calm = 0; calm < 3; ++i) {
    if (i === STEPS) fail('not at rest');
    mujoco.mj_step(model, data);
    let motion = 0;
    for (const speed of qvel) motion += (speed * step) ** 2;
    if (motion <= before) { // both are 0 where the rod is at rest from the beginning
      qvel.fill(0);
      if (chain.end) shiftWeld();
      calm = before < AT_REST ** 2 ? calm + 1 : 0;
      motion = 0;
    }
    before = motion;
  }
  mujoco.mj_forward(model, data);
  return [chain.hinge, ...chain.hinges.map((_, i) => [...data.xipos.subarray(3 * (i + 1), 3 * (i + 2))])];
}

const [scene, shape, model] = process.argv.slice(2);
if (!shape) fail('usage: mujoco.mjs SCENE SHAPE [MODEL.XML]');
const chain = readChain(JSON.parse(readFileSync(scene, 'utf8')));
const xml = mjcf(chain);
if (model) writeFileSync(model, xml);
const { default: load } = await import('@mujoco/mujoco'); // not before a scene is refused
const points = solve(await load(), chain, xml).slice(0, chain.end ? -1 : undefined);
const rows = [[...chain.origin, 0], ...points.map((point, i) => [...point, chain.at[i + 1]])];
if (chain.end) rows.push([...chain.end, chain.length]);
writeFileSync(shape, ['x,y,z,s', ...rows.map((row) => row.join(','))].join('\n') + '\n');
