"use strict";
// Draws the vehicle: scene data in vehicle axes (x forward, y right, z down) becomes plotly's, whose z is up, by a half
// turn about x: (x, -y, -z), so that nothing is mirrored. Bodies are rigid: a motion gives each a displacement and a
// rotation Rz(psi) Rx(phi) Ry(theta) about its centre of mass; what is fixed to it goes along.
(function () {
  var scene = JSON.parse(document.getElementById("scene").textContent);
  var place = document.getElementById("drawing");
  var REST = [0, 0, 0, 0, 0, 0], NAMES = ["x", "y", "z", "phi", "theta", "psi"];
  var CYCLE = 2.0; // s on the screen for one period of a mode at speed 1
  var hidden = {}, current = "iso", pose = {}, layers = [];

  function colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim() || "#888";
  }
  function escape(text) {
    return text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
  }
  function hover(lines) {
    return "<b>" + escape(lines[0]) + "</b><br>" + lines.slice(1).map(escape).join("<br>");
  }

  // A point fixed to a body, moved with it.
  function mover(body) {
    var q = pose[body.name] || REST, c = body.at;
    var cf = Math.cos(q[3]), sf = Math.sin(q[3]), ct = Math.cos(q[4]), st = Math.sin(q[4]), cp = Math.cos(q[5]), sp = Math.sin(q[5]);
    var r = [
      cp * ct - sp * sf * st, -sp * cf, cp * st + sp * sf * ct,
      sp * ct + cp * sf * st, cp * cf, sp * st - cp * sf * ct,
      -cf * st, sf, cf * ct
    ];
    return function (p) {
      var x = p[0] - c[0], y = p[1] - c[1], z = p[2] - c[2];
      return [
        c[0] + q[0] + r[0] * x + r[1] * y + r[2] * z,
        c[1] + q[1] + r[3] * x + r[4] * y + r[5] * z,
        c[2] + q[2] + r[6] * x + r[7] * y + r[8] * z
      ];
    };
  }

  function Points() { this.x = []; this.y = []; this.z = []; this.text = []; }
  Points.prototype.add = function (p, text) {
    this.x.push(p[0]); this.y.push(-p[1]); this.z.push(-p[2]); this.text.push(text || "");
  };
  Points.prototype.gap = function () { this.x.push(null); this.y.push(null); this.z.push(null); this.text.push(""); };

  function mesh(pieces, move) {
    var points = new Points(), i = [], j = [], k = [];
    pieces.forEach(function (piece) {
      if (!piece.faces.length) { return; }
      var first = points.x.length;
      piece.vertices.forEach(function (p) { points.add(move(p)); });
      piece.faces.forEach(function (f) { i.push(first + f[0]); j.push(first + f[1]); k.push(first + f[2]); });
    });
    return { points: points, i: i, j: j, k: k };
  }
  function edges(points, pieces, move) {
    pieces.forEach(function (piece) {
      piece.edges.forEach(function (e) {
        points.add(move(piece.vertices[e[0]])); points.add(move(piece.vertices[e[1]])); points.gap();
      });
    });
  }
  function still(p) { return p; }

  var byName = {};
  scene.bodies.forEach(function (body) { byName[body.name] = body; });

  // What moves: each layer gives its points anew in a pose, in the same order.
  var moving = [];
  function add(layer, role, make, trace, moves) {
    layers.push({ layer: layer, role: role, trace: trace, make: make });
    if (moves) { moving.push(layers.length - 1); }
  }
  function movers() {
    var all = {};
    scene.bodies.forEach(function (body) { all[body.name] = mover(body); });
    return all;
  }

  scene.bodies.forEach(function (body) {
    if (!body.pieces.some(function (piece) { return piece.faces.length; })) { return; }
    var wheels = body.kind === "wheelset";
    // the largest body is glass, so that what is inside can be seen
    add(wheels ? "wheelsets" : "bodies", wheels ? "steel" : body.glass ? "body" : "frame",
      function (all) { return mesh(body.pieces, all[body.name]); },
      { type: "mesh3d", name: body.name, hoverinfo: "skip", flatshading: true, opacity: wheels ? 1 : body.glass ? 0.14 : 0.3,
        lighting: { ambient: 0.7, diffuse: 0.5, specular: 0, fresnel: 0 } }, true);
  });
  ["body", "wheelset"].forEach(function (kind) {
    var own = scene.bodies.filter(function (body) { return body.kind === kind; });
    if (!own.length) { return; }
    add(kind === "body" ? "bodies" : "wheelsets", kind === "body" ? "body" : "ink", function (all) {
      var points = new Points();
      own.forEach(function (body) { edges(points, body.pieces, all[body.name]); });
      return { points: points };
    }, { type: "scatter3d", mode: "lines", name: kind, hoverinfo: "skip", line: { width: kind === "body" ? 2.5 : 1 }, opacity: kind === "body" ? 1 : 0.45 }, true);
  });
  add("centres of mass", "ink", function (all) {
    var points = new Points();
    scene.bodies.forEach(function (body) { points.add(all[body.name](body.at), hover(body.hover)); });
    return { points: points };
  }, { type: "scatter3d", mode: "markers", name: "centres of mass", hoverinfo: "text", marker: { size: 5, symbol: "cross" } }, true);
  scene.groups.forEach(function (group, number) {
    var own = scene.connections.filter(function (one) { return one.group === group; });
    add(group, String(number % 12 + 1), function (all) {
      var points = new Points();
      own.forEach(function (one) {
        one.points.forEach(function (p, end) { points.add(all[one.between[end]](p), hover(one.hover)); });
        points.gap();
      });
      return { points: points };
    }, { type: "scatter3d", mode: "lines+markers", name: group, hoverinfo: "text", line: { width: 7 }, marker: { size: 5, symbol: "circle" } }, true);
  });
  add("brackets", "soft", function (all) {
    var points = new Points();
    scene.connections.forEach(function (one) {
      one.points.forEach(function (p, end) {
        var move = all[one.between[end]];
        points.add(move(p)); points.add(move(one.feet[end])); points.gap();
      });
    });
    return { points: points };
  }, { type: "scatter3d", mode: "lines", name: "brackets", hoverinfo: "skip", line: { width: 2 } }, true);
  if (scene.sensors.length) {
    add("sensors", "fail", function (all) {
      var points = new Points();
      scene.sensors.forEach(function (one) { points.add(all[one.body](one.at), hover(one.hover)); });
      return { points: points };
    }, { type: "scatter3d", mode: "markers", name: "sensors", hoverinfo: "text", marker: { size: 4, symbol: "diamond" } }, true);
  }
  if (scene.rails.length) {
    add("rails", "rail", function () { return mesh(scene.rails, still); },
      { type: "mesh3d", name: "rails", hoverinfo: "skip", flatshading: true, lighting: { ambient: 0.7, diffuse: 0.5, specular: 0, fresnel: 0 } });
  }
  if (scene.outline) {
    add("outline", "outline", function () {
      var points = new Points();
      scene.outline.lines.forEach(function (line) { line.forEach(function (p) { points.add(p); }); points.gap(); });
      return { points: points };
    }, { type: "scatter3d", mode: "lines", name: "outline", hoverinfo: "skip", line: { width: 1.5 } });
    add("outline", "outline", function () {
      var points = new Points();
      scene.outline.couplers.forEach(function (p) { points.add(p, hover(scene.outline.hover)); });
      return { points: points };
    }, { type: "scatter3d", mode: "markers", name: "couplers", hoverinfo: "text", marker: { size: 4, symbol: "square" } });
  }
  add("axes", "ink", function () {
    var points = new Points();
    [["x", [1.5, 0, 0]], ["y", [0, 1.5, 0]], ["z", [0, 0, 1.5]]].forEach(function (axis) {
      points.add([0, 0, 0]); points.add(axis[1]); points.text[points.text.length - 1] = axis[0]; points.gap();
    });
    return { points: points };
  }, { type: "scatter3d", mode: "lines+text", name: "axes", hoverinfo: "skip", line: { width: 6 }, textposition: "top center", textfont: { size: 16 } });
  if (scene.findings.length) {
    add("found", "fail", function () {
      var points = new Points();
      scene.findings.forEach(function (one) { points.add(one.at, hover(["found", one.message])); });
      return { points: points };
    }, { type: "scatter3d", mode: "markers", name: "found", hoverinfo: "text", marker: { size: 14, symbol: "circle-open" } });
  }

  function traces() {
    var all = movers();
    return layers.map(function (one) {
      var made = one.make(all), own = colour(/^[0-9]+$/.test(one.role) ? "c" + one.role : one.role);
      var trace = Object.assign({}, one.trace, {
        x: made.points.x, y: made.points.y, z: made.points.z, showlegend: false, visible: !hidden[one.layer], connectgaps: false
      });
      if (trace.type === "mesh3d") {
        trace.i = made.i; trace.j = made.j; trace.k = made.k; trace.color = own;
      } else {
        trace.hovertext = made.points.text;
        if (trace.mode.indexOf("text") >= 0) { trace.text = made.points.text; trace.textfont = Object.assign({ color: own }, trace.textfont); }
        if (trace.line) { trace.line = Object.assign({ color: own }, trace.line); }
        if (trace.marker) { trace.marker = Object.assign({ color: own }, trace.marker); }
      }
      return trace;
    });
  }

  // ---------------------------------------------------------------- views

  var margin = 0.6;
  var low = scene.extent[0].map(function (v) { return v - margin; }), high = scene.extent[1].map(function (v) { return v + margin; });
  high[2] = Math.max(high[2], 0.4);
  var least = [low[0], -high[1], -high[2]], most = [high[0], -low[1], -low[2]];
  var span = [0, 1, 2].map(function (i) { return most[i] - least[i]; });
  var unit = Math.max.apply(null, span) / 2; // m in one of plotly's units
  var size = span.map(function (v) { return v / unit; });
  var SEEN = 2.0; // height seen, in plotly's units: in parallel projection it does not depend on where the camera is

  // Parallel projection throughout: plotly builds its scene anew where the projection changes. How near things are is
  // then the size of the scene's box.
  var LEVEL = { front: [1, 0, 0], side: [0, -1, 0], iso: [1, -1.15, 0.7] };

  function framing(view) {
    var box = place.getBoundingClientRect(), across = box.width / Math.max(box.height, 1);
    var upright = across < 1; // on a phone the vehicle stands on its tail, seen from above
    var eye = view === "top" ? [0, 0, 1] : LEVEL[view];
    var up = view !== "top" ? [0, 0, 1] : upright ? [1, 0, 0] : [0, 1, 0];
    var n = Math.hypot(eye[0], eye[1], eye[2]);
    eye = eye.map(function (v) { return v / n; });
    // height and width of the box of everything on the screen
    var right = [up[1] * eye[2] - up[2] * eye[1], up[2] * eye[0] - up[0] * eye[2], up[0] * eye[1] - up[1] * eye[0]];
    var m = Math.hypot(right[0], right[1], right[2]);
    right = right.map(function (v) { return v / m; });
    var above = [eye[1] * right[2] - eye[2] * right[1], eye[2] * right[0] - eye[0] * right[2], eye[0] * right[1] - eye[1] * right[0]];
    function seen(along) { return along.reduce(function (sum, v, i) { return sum + Math.abs(v) * size[i]; }, 0); }
    var scale = 0.86 * SEEN / Math.max(seen(above), seen(right) / across), far = 2;
    return {
      aspectratio: { x: scale * size[0], y: scale * size[1], z: scale * size[2] },
      camera: {
        eye: { x: far * eye[0], y: far * eye[1], z: far * eye[2] }, up: { x: up[0], y: up[1], z: up[2] },
        center: { x: 0, y: 0, z: 0 }, projection: { type: "orthographic" }
      }
    };
  }

  function axis(name, i, sign) {
    var step = span[i] > 12 ? 2 : 1, values = [], texts = [];
    for (var v = Math.ceil(least[i] / step) * step; v <= most[i]; v += step) { values.push(v); texts.push(String(sign * v || 0)); }
    return {
      title: { text: name, font: { size: 13 } }, range: [least[i], most[i]], tickvals: values, ticktext: texts, autorange: false,
      color: colour("soft"), gridcolor: colour("grid"), zeroline: false, showbackground: false, showspikes: false, tickfont: { size: 10 }
    };
  }
  function layout(view) {
    var box = place.getBoundingClientRect();
    return {
      width: place.clientWidth || box.width, height: place.clientHeight || box.height,
      margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: "rgba(0,0,0,0)", showlegend: false, hovermode: "closest",
      font: { color: colour("ink"), family: "system-ui, -apple-system, Segoe UI, Roboto, Arial, sans-serif" },
      hoverlabel: { bgcolor: colour("paper"), bordercolor: colour("soft"), align: "left", font: { color: colour("ink"), size: 12 } },
      scene: {
        aspectmode: "manual", aspectratio: framing(view).aspectratio, dragmode: "orbit", camera: framing(view).camera,
        xaxis: axis("x forward (m)", 0, 1), yaxis: axis("y right (m)", 1, -1), zaxis: axis("z down (m)", 2, -1), bgcolor: "rgba(0,0,0,0)"
      }
    };
  }
  var config = { displayModeBar: false, scrollZoom: true };

  function look(view) {
    current = view;
    document.querySelectorAll("[data-view]").forEach(function (button) {
      button.setAttribute("aria-pressed", String(button.dataset.view === view));
    });
    var fit = framing(view);
    return Plotly.relayout(place, {
      "scene.camera": fit.camera, "scene.aspectratio": fit.aspectratio,
      // the axis that points at the reader has nothing to say
      "scene.xaxis.visible": view !== "front", "scene.yaxis.visible": view !== "side", "scene.zaxis.visible": view !== "top"
    });
  }
  document.querySelectorAll("[data-view]").forEach(function (button) {
    button.addEventListener("click", function () { look(button.dataset.view); });
  });
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", function () {
    var now = place.layout.scene, next = layout(current);
    next.scene.camera = now.camera;
    next.scene.aspectratio = now.aspectratio;
    Plotly.react(place, traces(), next, config);
  });

  var resized = 0;
  window.addEventListener("resize", function () {
    window.clearTimeout(resized);
    resized = window.setTimeout(function () {
      Plotly.relayout(place, { width: place.clientWidth, height: place.clientHeight }).then(function () { return look(current); });
    }, 150);
  });

  // ---------------------------------------------------------------- what is shown

  var bar = document.querySelector(".layers");
  layers.map(function (one) { return one.layer; }).filter(function (name, i, all) { return all.indexOf(name) === i; }).forEach(function (name) {
    var first = layers.filter(function (one) { return one.layer === name; })[0];
    var button = document.createElement("button"), dot = document.createElement("i");
    dot.style.background = "var(--" + (/^[0-9]+$/.test(first.role) ? "c" + first.role : first.role) + ")";
    button.type = "button";
    button.dataset.layer = name;
    button.setAttribute("aria-pressed", "true");
    button.append(dot, name);
    button.addEventListener("click", function () {
      hidden[name] = !hidden[name];
      button.setAttribute("aria-pressed", String(!hidden[name]));
      var which = [];
      layers.forEach(function (one, i) { if (one.layer === name) { which.push(i); } });
      Plotly.restyle(place, { visible: !hidden[name] }, which);
    });
    bar.append(button);
  });

  // ---------------------------------------------------------------- motion

  var which = document.getElementById("which"), play = document.getElementById("play");
  var magnification = document.getElementById("magnification"), pace = document.getElementById("pace"), time = document.getElementById("time");
  var playing = false, clock = 0, before = null, busy = false;

  function motion() { return which.value === "" ? null : scene.motions[Number(which.value)]; }
  function slid(slider) { return Math.pow(10, Number(slider.value)); }
  function shown(value) { return value < 10 ? value.toFixed(2).replace(/0+$/, "").replace(/\.$/, "") : value.toFixed(0); }

  // Displacements of every body at the clock, magnified.
  function posed() {
    var now = motion(), by = slid(magnification);
    pose = {};
    if (!now) { return; }
    if (now.kind === "mode") {
      var angle = 2 * Math.PI * clock / CYCLE, c = by * Math.cos(angle), s = by * Math.sin(angle);
      Object.keys(now.bodies).forEach(function (body) {
        pose[body] = now.bodies[body].map(function (value) { return c * value[0] - s * value[1]; });
      });
      return;
    }
    var row = nearest(now.t, clock);
    Object.keys(now.bodies).forEach(function (body) {
      pose[body] = NAMES.map(function (name) { return name in now.bodies[body] ? by * now.bodies[body][name][row] : 0; });
    });
    time.value = row;
    document.getElementById("timed").textContent = now.t[row].toFixed(2) + " s";
  }
  function nearest(t, value) {
    var a = 0, b = t.length - 1;
    while (b - a > 1) { var m = (a + b) >> 1; if (t[m] <= value) { a = m; } else { b = m; } }
    return value - t[a] < t[b] - value ? a : b;
  }
  function redraw() {
    posed();
    var all = movers(), x = [], y = [], z = [];
    moving.forEach(function (i) {
      var points = layers[i].make(all).points;
      x.push(points.x); y.push(points.y); z.push(points.z);
    });
    return Plotly.restyle(place, { x: x, y: y, z: z }, moving);
  }
  function draw() {
    if (busy) { return; }
    busy = true;
    Promise.resolve(redraw()).then(function () { busy = false; }, function () { busy = false; });
  }
  function frame(now) {
    if (!playing) { before = null; return; }
    if (before !== null && !busy && now - before > 30) {
      clock += Math.min((now - before) / 1000, 0.2) * slid(pace);
      var one = motion();
      if (one && one.kind === "run") {
        var last = one.t[one.t.length - 1];
        if (clock > last) { clock = one.t[0]; }
      }
      draw();
      before = now;
    } else if (before === null) {
      before = now;
    }
    window.requestAnimationFrame(frame);
  }
  function start(on) {
    playing = on && motion() !== null;
    play.setAttribute("aria-pressed", String(playing));
    play.textContent = playing ? "Pause" : "Play";
    if (playing) { before = null; window.requestAnimationFrame(frame); }
  }
  function labels() {
    document.getElementById("magnified").textContent = shown(slid(magnification)) + " x";
    document.getElementById("paced").textContent = shown(slid(pace)) + " x";
  }
  if (scene.motions.length) { document.getElementById("motion").hidden = false; }
  which.addEventListener("change", function () {
    var one = motion();
    document.getElementById("timing").hidden = !(one && one.kind === "run");
    clock = 0;
    if (one && one.kind === "run") { time.max = one.t.length - 1; clock = one.t[0]; }
    magnification.value = one && one.kind === "run" ? 1 : 0;
    labels();
    draw();
    start(one !== null);
  });
  play.addEventListener("click", function () { start(!playing); });
  [magnification, pace].forEach(function (slider) { slider.addEventListener("input", function () { labels(); draw(); }); });
  time.addEventListener("input", function () { clock = motion().t[Number(time.value)]; start(false); draw(); });
  labels();

  Plotly.newPlot(place, traces(), layout("iso"), config);
})();
