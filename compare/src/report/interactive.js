// What a report's page does besides being read: shapes to turn and to look along, and sliders over
// a grid of shapes that were computed with the page. Without scripts none of it is there.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("page-data").textContent);
  const SVG = "http://www.w3.org/2000/svg";
  const gap = 16;        // around what is drawn [pixels]
  const turn_of_key = 5; // [degrees]

  const element = (name, attributes = {}, ...children) => {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  };
  const drawn = (parent, name, attributes, text) => {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    parent.append(made);
    return made;
  };
  const number = (value, digits = 4) =>
    value === null || value === undefined ? "–" : String(Number(value.toPrecision(digits)));
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) =>
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = axis => [0, 1, 2].map(i => (i === axis ? 1 : 0));
  const points_of = curve => curve.x.map((x, i) => [x, curve.y[i], curve.z ? curve.z[i] : 0]);
  // Lines end where a point is missing.
  const path_of = points =>
    points.map((p, i) => p === null ? "" :
      `${i === 0 || points[i - 1] === null ? "M" : "L"}${p[0].toFixed(1)},${p[1].toFixed(1)}`)
      .join("");
  // 1, 2 or 5 times a power of ten, at most a length.
  const round_length = most => {
    const power = 10 ** Math.floor(Math.log10(most));
    return power * [5, 2, 1].find(leading => leading * power <= most);
  };
  const legend_of = curves => {
    const list = element("ul", {class: "legend"});
    curves.forEach((curve, i) => {
      const swatch = document.createElementNS(SVG, "svg");
      swatch.setAttribute("viewBox", "0 0 36 12");
      swatch.setAttribute("aria-hidden", "true");
      drawn(swatch, "line", {class: `curve c${i}`, x1: 1, y1: 6, x2: 35, y2: 6});
      list.append(element("li", {}, swatch, curve.name));
    });
    return list;
  };

  /// A picture of curves in the room that the page gives it.
  class Stage {
    constructor(label, attributes = {}) {
      this.root = element("div", {class: "stage", ...attributes});
      this.svg = document.createElementNS(SVG, "svg");
      this.svg.setAttribute("role", "img");
      this.svg.setAttribute("aria-label", label);
      this.root.append(this.svg);
      this.draw = () => {};
      new ResizeObserver(() => {
        const width = Math.round(this.root.clientWidth);
        if (width !== this.width && width > 0) this.draw();
      }).observe(this.root);
    }
    /// Empties it. @return its width; the height is the share of it, but no more than a screen's
    clear(share) {
      this.width = Math.max(Math.round(this.root.clientWidth), 200);
      this.height = Math.round(Math.min(Math.max(share * this.width, 120), 460));
      this.svg.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
      this.svg.setAttribute("height", this.height);
      this.svg.replaceChildren();
    }
    curve(points, i, kind) {
      drawn(this.svg, "path", {class: `curve c${i}`, d: path_of(points)});
      if (kind !== "polygon") return;
      for (const p of points) drawn(this.svg, "circle", {class: `point c${i}`, cx: p[0].toFixed(1),
                                                         cy: p[1].toFixed(1), r: 2.6});
    }
    scale_bar(pixels_per_unit, name) {
      const length = round_length(0.3 * this.width / pixels_per_unit);
      const end = gap + length * pixels_per_unit;
      drawn(this.svg, "path", {class: "axis", d: `M${gap},${this.height - 8}H${end.toFixed(1)}`});
      drawn(this.svg, "text", {x: gap, y: this.height - 13}, name(length));
    }
  }

  const bounds_of = points => [0, 1].map(axis => {
    const values = points.map(p => p[axis]);
    return [Math.min(...values), Math.max(...values)];
  });
  const extent = range => range[1] - range[0];

  /// Shapes of a scene: hovered, moved along and, in space, turned.
  class SceneViewer {
    constructor(root) {
      this.select = element("select", {id: "view-scene"});
      data.scenes.forEach((scene, i) => this.select.append(element("option", {value: i}, scene.name)));
      this.help = element("p", {class: "faint"});
      this.buttons = element("span", {class: "turns"});
      for (const [name, label, yaw, pitch] of [["◀", "turn left", -1, 0], ["▶", "turn right", 1, 0],
                                               ["▲", "turn up", 0, -1], ["▼", "turn down", 0, 1]]) {
        const button = element("button", {type: "button", "aria-label": label, title: label}, name);
        button.addEventListener("click", () => this.turn(3 * yaw * turn_of_key, 3 * pitch * turn_of_key));
        this.buttons.append(button);
      }
      const reset = element("button", {type: "button"}, "as at first");
      reset.addEventListener("click", () => this.turn_back());
      this.buttons.append(reset);
      this.stage = new Stage("Shapes of the scene", {tabindex: "0", role: "group", id: "view-stage"});
      this.stage.draw = () => this.draw();
      this.readout = element("output", {id: "view-readout", "aria-live": "polite", for: "view-stage"});
      this.legend = element("div");
      root.append(element("p", {class: "controls"},
                          element("label", {for: "view-scene"}, "Scene "), this.select, this.buttons),
                  this.help, this.stage.root, this.readout, this.legend);
      this.select.addEventListener("change", () => this.show(Number(this.select.value)));
      this.stage.root.addEventListener("keydown", event => this.key(event));
      this.stage.root.addEventListener("pointerdown", event => this.press(event));
      this.stage.root.addEventListener("pointermove", event => this.move(event));
      for (const end of ["pointerup", "pointercancel"]) {
        this.stage.root.addEventListener(end, () => { this.dragged = null; });
      }
      this.show(0);
    }

    show(index) {
      this.scene = data.scenes[index];
      const [right, up] = this.scene.view.map(unit);
      this.first = [right, up, cross(right, up)];
      this.curves = this.scene.curves.map(curve => ({...curve, points: points_of(curve)}));
      this.at = {curve: 0, point: this.curves[0].points.length - 1};
      this.buttons.hidden = !this.scene.spatial;
      this.help.textContent = (this.scene.spatial ?
        "Drag to turn, or Shift with the arrow keys; 0 turns back. " : "The rod stays in a plane. ") +
        "Point at a shape, or use the arrow keys: left and right along it (Home and End to its ends), " +
        "up and down from shape to shape.";
      this.legend.replaceChildren(legend_of(this.curves));
      this.stage.svg.setAttribute("aria-label", `Shapes of ${this.scene.name}`);
      const all = this.curves.flatMap(curve => curve.points);
      const middle = axis => {
        const values = all.map(p => p[axis]);
        return (Math.min(...values) + Math.max(...values)) / 2;
      };
      this.centre = [0, 1, 2].map(middle);
      this.radius = Math.max(...all.map(p => Math.hypot(...p.map((v, i) => v - this.centre[i]))));
      this.turn_back();
    }
    turn_back() {
      [this.yaw, this.pitch] = [0, 0];
      this.draw();
    }
    turn(yaw, pitch) {
      if (!this.scene.spatial) return;
      this.yaw = (this.yaw + yaw) % 360;
      this.pitch = Math.min(Math.max(this.pitch + pitch, -90), 90);
      this.draw();
    }
    /// To the right and up on the screen [m].
    seen(point) {
      const [right, up, to_reader] = this.first;
      const from = point.map((v, i) => v - this.centre[i]);
      const [a, b] = [this.yaw, this.pitch].map(angle => angle * Math.PI / 180);
      const x = dot(from, right) * Math.cos(a) + dot(from, to_reader) * Math.sin(a);
      const depth = dot(from, to_reader) * Math.cos(a) - dot(from, right) * Math.sin(a);
      return [x, dot(from, up) * Math.cos(b) - depth * Math.sin(b)];
    }
    draw() {
      const planar = bounds_of(this.curves.flatMap(curve => curve.points.map(p => this.seen(p))));
      const [width, height] = this.scene.spatial ? [2 * this.radius, 2 * this.radius] :
        planar.map(range => Math.max(extent(range), 0.05 * this.scene.length_m));
      const middle = this.scene.spatial ? [0, 0] : planar.map(range => (range[0] + range[1]) / 2);
      this.stage.clear(this.scene.spatial ? 0.8 : height / width + 0.12);
      const room = 2 * gap + 14;
      const scale = Math.min((this.stage.width - room) / width, (this.stage.height - room - 14) / height);
      this.on_screen = point => {
        const [x, y] = this.seen(point);
        return [this.stage.width / 2 + (x - middle[0]) * scale,
                this.stage.height / 2 - 8 - (y - middle[1]) * scale];
      };
      const svg = this.stage.svg;
      for (const outline of this.scene.outlines) {
        const points = outline.x.map((x, i) => x === null ? null :
          this.on_screen([x, outline.y[i], outline.z[i]]));
        drawn(svg, "path", {class: "obstacle", d: path_of(points) + "Z"});
      }
      for (const gripper of this.scene.grippers) {
        const at = this.on_screen(gripper.position);
        if (gripper.direction) {
          const ends = [-1, 1].map(sign => this.on_screen(gripper.position.map(
            (v, i) => v + sign * 0.04 * this.scene.length_m * gripper.direction[i])));
          drawn(svg, "path", {class: "clamp", d: path_of(ends)});
        } else {
          drawn(svg, "circle", {class: "clamp", cx: at[0].toFixed(1), cy: at[1].toFixed(1), r: 5});
        }
      }
      this.curves.forEach((curve, i) =>
        this.stage.curve(curve.points.map(this.on_screen), i, curve.kind));
      if (this.scene.spatial) this.draw_axes();
      this.stage.scale_bar(scale, length => `${number(length)} m`);
      this.mark = drawn(svg, "circle", {class: "mark", r: 7});
      this.tell();
    }
    draw_axes() {
      const [x, y] = [this.stage.width - 44, 44];
      [0, 1, 2].forEach(axis => {
        const tip = this.seen(unit(axis).map((v, i) => v + this.centre[i]));
        drawn(this.stage.svg, "path", {class: "axis", d: `M${x},${y}l${(24 * tip[0]).toFixed(1)},${(-24 * tip[1]).toFixed(1)}`});
        if (Math.hypot(...tip) < 0.2) return;
        drawn(this.stage.svg, "text", {"text-anchor": "middle", x: (x + 34 * tip[0]).toFixed(1),
                                       y: (y - 34 * tip[1] + 4).toFixed(1)}, "xyz"[axis]);
      });
    }
    tell() {
      const curve = this.curves[this.at.curve];
      const i = this.at.point;
      const [x, y] = this.on_screen(curve.points[i]);
      this.mark.setAttribute("cx", x.toFixed(1));
      this.mark.setAttribute("cy", y.toFixed(1));
      const parts = [`s = ${number(curve.s[i])} m`];
      if (curve.curvature[i] !== null) parts.push(`curvature ${number(curve.curvature[i])} 1/m`);
      if (curve.tension) parts.push(`tension ${number(curve.tension[i])} N`);
      if (curve.distance) parts.push(`${number(1e3 * curve.distance[i])} mm from the energy model`);
      this.readout.textContent = `${curve.name}: ${parts.join(", ")}`;
    }
    key(event) {
      const along = {ArrowLeft: -1, ArrowRight: 1}[event.key];
      const across = {ArrowUp: -1, ArrowDown: 1}[event.key];
      const here = this.curves[this.at.curve];
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      if (event.shiftKey && this.scene.spatial && (along || across)) {
        this.turn((along || 0) * turn_of_key, (across || 0) * turn_of_key);
      } else if (along) {
        const step = along * (here.kind === "rod" ? 2 : 1);
        this.at.point = Math.min(Math.max(this.at.point + step, 0), here.points.length - 1);
        this.tell();
      } else if (across) {
        const count = this.curves.length;
        this.at.curve = (this.at.curve + across + count) % count;
        const s = here.s[this.at.point];
        const distances = this.curves[this.at.curve].s.map(other => Math.abs(other - s));
        this.at.point = distances.indexOf(Math.min(...distances));
        this.tell();
      } else if (event.key === "Home" || event.key === "End") {
        this.at.point = event.key === "Home" ? 0 : here.points.length - 1;
        this.tell();
      } else if (event.key === "0") {
        this.turn_back();
      } else {
        return;
      }
      event.preventDefault();
    }
    press(event) {
      if (!this.scene.spatial) return;
      this.dragged = [event.clientX, event.clientY];
      this.stage.root.setPointerCapture(event.pointerId);
    }
    move(event) {
      if (this.dragged) {
        const [x, y] = this.dragged;
        this.dragged = [event.clientX, event.clientY];
        this.turn((event.clientX - x) / 2, (event.clientY - y) / 2);
        return;
      }
      const box = this.stage.svg.getBoundingClientRect();
      const pointer = [event.clientX - box.left, event.clientY - box.top];
      let least = 40;  // [pixels]
      this.curves.forEach((curve, c) => curve.points.forEach((point, i) => {
        const [x, y] = this.on_screen(point);
        const away = Math.hypot(x - pointer[0], y - pointer[1]);
        if (away < least) [least, this.at] = [away, {curve: c, point: i}];
      }));
      this.tell();
    }
  }

  const nearest = (values, wanted) => {
    const distances = values.map(value => Math.abs(value - wanted));
    return distances.indexOf(Math.min(...distances));
  };

  /// Sliders over a grid of shapes; the nearest is shown.
  class GridViewer {
    constructor(root, grid) {
      this.grid = grid;
      this.logs = grid.gammas.map(Math.log10);
      const controls = element("div", {class: "sliders"});
      const slider = (id, label, values, step, at) => {
        // Whole steps, or the last value could not be reached.
        const [min, max] = [Math.floor(values[0] / step), Math.ceil(values[values.length - 1] / step)];
        const input = element("input", {type: "range", id, min: min * step, max: max * step, step, value: at});
        const shown = element("output", {for: id});
        controls.append(element("label", {for: id}, label), input, shown);
        input.addEventListener("input", () => this.draw());
        return {input, shown};
      };
      this.gamma = slider("grid-gamma", "Γ, weight against stiffness", this.logs, 0.01,
                          this.logs[Math.floor(this.logs.length / 2)]);
      this.angle = slider("grid-angle", "clamp above the horizontal", grid.angles_deg, 1, 0);
      this.points = slider("grid-points", "points N of the force model", grid.points, 1, 16);
      this.law = element("select", {id: "grid-law"});
      grid.models.forEach((model, i) => this.law.append(element(
        "option", {value: i}, `${model.law}, bookkeeping ${model.bookkeeping}`)));
      this.law.addEventListener("change", () => this.draw());
      controls.append(element("label", {for: "grid-law"}, "law of the joints"), this.law,
                      element("span"));
      this.readout = element("output", {id: "grid-readout", "aria-live": "polite"});
      this.shapes = new Stage("Both shapes");
      this.distance = new Stage("Distance along the rod");
      this.shapes.draw = this.distance.draw = () => this.draw();
      const of = (values, unit_name) => values.map(v => `${v}${unit_name}`).join(", ");
      root.append(
        element("p", {}, `Computed with this page: ${grid.cells.length} pairs of shapes of the paper's ` +
          `rod under its weight, for Γ = ${of(grid.gammas, "")}; the clamp at ` +
          `${of(grid.angles_deg, "°")}; N = ${of(grid.points, "")}; and both laws. Between these ` +
          "values the nearest is shown, not interpolated."),
        controls, this.readout,
        element("div", {class: "pair"}, this.shapes.root, this.distance.root),
        legend_of([{name: "energy model"}, {name: "force model, whose distance at equal arc length is on " +
          "the right, or below"}]));
      this.draw();
    }
    draw() {
      const grid = this.grid;
      const wanted = {gamma: Number(this.gamma.input.value), angle: Number(this.angle.input.value),
                      points: Number(this.points.input.value)};
      const [g, a, n] = [nearest(this.logs, wanted.gamma), nearest(grid.angles_deg, wanted.angle),
                         nearest(grid.points, wanted.points)];
      const m = Number(this.law.value);
      const state = (shown, value, wanted_value) =>
        shown === wanted_value ? value(shown) : `${value(wanted_value)} → ${value(shown)}`;
      this.gamma.shown.textContent =
        state(grid.gammas[g], number, Number((10 ** wanted.gamma).toPrecision(2)));
      this.angle.shown.textContent = state(grid.angles_deg[a], v => `${v}°`, wanted.angle);
      this.points.shown.textContent = state(grid.points[n], number, wanted.points);
      const place = ((g * grid.angles_deg.length + a) * grid.points.length + n) * grid.models.length + m;
      const cell = grid.cells[place];
      const where = `Γ = ${grid.gammas[g]}, clamp at ${grid.angles_deg[a]}°, N = ${grid.points[n]}, ` +
        `law ${grid.models[m].law}, bookkeeping ${grid.models[m].bookkeeping}: `;
      if (cell.failure) {
        this.readout.textContent = where + "not computed: " + cell.failure;
        for (const stage of [this.shapes, this.distance]) stage.clear(0.3);
        return;
      }
      this.readout.textContent = where + `${number(100 * cell.rms, 3)} % of the length apart (RMS), at ` +
        `most ${number(100 * cell.max, 3)} %, at s = ${number(cell.max_at, 3)} l`;
      this.draw_shapes(cell, grid.angles_deg[a]);
      this.draw_distance(cell);
    }
    draw_shapes(cell, angle) {
      this.shapes.clear(0.8);  // one scale for all: no shape is wider or higher than its length
      const scale = Math.min(this.shapes.width, this.shapes.height - 2 * gap) - 2 * gap;
      const all = points_of(cell.rod).concat(points_of(cell.polygon)).map(p => p.map(v => v / 1e4));
      const middle = bounds_of(all).map(range => (range[0] + range[1]) / 2);
      const on_screen = p => [this.shapes.width / 2 + (p[0] / 1e4 - middle[0]) * scale,
                              this.shapes.height / 2 - (p[1] / 1e4 - middle[1]) * scale];
      const along = [Math.cos(angle * Math.PI / 180), Math.sin(angle * Math.PI / 180)];
      const ends = [-400, 400].map(end => on_screen(along.map(v => v * end)));
      drawn(this.shapes.svg, "path", {class: "clamp", d: path_of(ends)});
      this.shapes.curve(points_of(cell.rod).map(on_screen), 0, "rod");
      this.shapes.curve(points_of(cell.polygon).map(on_screen), 1, "polygon");
      this.shapes.scale_bar(scale, length => `${number(length)} l`);
    }
    draw_distance(cell) {
      const stage = this.distance;
      stage.clear(0.8);
      const [left, top, right, bottom] = [52, 26, stage.width - gap, stage.height - 40];
      const largest = Math.max(...cell.distance, 1) / 100;  // [%]
      const step = round_length(largest / 2);
      const height = step * Math.ceil(1.0001 * largest / step);
      const x = s => left + s * (right - left);
      const y = percent => bottom - percent / height * (bottom - top);
      for (let tic = 0; tic <= height * 1.0001; tic += step) {
        drawn(stage.svg, "path", {class: "grid", d: `M${left},${y(tic).toFixed(1)}H${right}`});
        drawn(stage.svg, "text", {"text-anchor": "end", x: left - 6, y: y(tic).toFixed(1), dy: 4},
              number(tic, 3));
      }
      for (const s of [0, 0.5, 1]) {
        drawn(stage.svg, "path", {class: "grid", d: `M${x(s).toFixed(1)},${top}V${bottom}`});
        drawn(stage.svg, "text", {"text-anchor": "middle", x: x(s).toFixed(1), y: bottom + 16}, s);
      }
      drawn(stage.svg, "text", {x: 4, y: 14}, "distance [% of the length]");
      drawn(stage.svg, "text", {"text-anchor": "end", x: right, y: bottom + 34}, "arc length s / l");
      const points = cell.s.map((s, i) => [x(s / 1e4), y(cell.distance[i] / 100)]);
      stage.curve(points, 1, "polygon");
    }
  }

  // What is drawn has to have its width.
  const shown = id => {
    const root = document.getElementById(id);
    root.hidden = false;
    return root;
  };
  if (data.scenes.length === 0 && !data.grid) return;
  for (const section of document.querySelectorAll("[data-needs-script]")) section.hidden = false;
  if (data.scenes.length > 0) new SceneViewer(shown("viewer"));
  if (data.grid) new GridViewer(shown("grid"), data.grid);
})();
