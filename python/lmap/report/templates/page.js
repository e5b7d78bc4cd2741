"use strict";
// Draws the figures: each stands as JSON beside its place, is drawn when it comes into sight and again when the
// reader asks for another view, when colours change and for paper.
(function () {
  var HEIGHT = 340, ROW = 110, PRINT_WIDTH = 660;
  var figures = [];

  function colour(role) {
    var style = getComputedStyle(document.documentElement);
    var name = /^[0-9]+$/.test(role) ? "c" + ((Number(role) - 1) % 12 + 1) : role;
    return style.getPropertyValue("--" + name).trim() || "#888";
  }

  function drawing(view, width) {
    var ink = colour("ink"), soft = colour("soft"), grid = colour("grid"), paper = colour("paper");
    var narrow = width < 520;
    var data = view.data.map(function (trace) {
      var copy = Object.assign({}, trace, { showlegend: false, xaxis: "x" });
      var own = colour(trace.meta.role);
      if (trace.line) { copy.line = Object.assign({}, trace.line, { color: own }); }
      if (trace.marker) {
        copy.marker = Object.assign({}, trace.marker, { color: own, line: Object.assign({}, trace.marker.line, { color: own }) });
      }
      if (trace.meta.group in view.hidden) { copy.visible = !view.hidden[trace.meta.group]; }
      return copy;
    });
    var layout = {
      height: view.layout.height ? (narrow ? Math.min(view.layout.height, 400) : view.layout.height) : view.layout.rows > 1 ? Math.max(HEIGHT, ROW * view.layout.rows + 60) : (narrow ? 290 : HEIGHT),
      width: width,
      margin: { l: narrow ? 52 : 64, r: 10, t: 8, b: 44 },
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      font: { color: ink, size: 12, family: "system-ui, -apple-system, Segoe UI, Roboto, Arial, sans-serif" },
      hovermode: "closest", hoverlabel: { bgcolor: paper, bordercolor: soft, font: { color: ink } },
      dragmode: window.matchMedia("(pointer: coarse)").matches ? false : "zoom",
      showlegend: false
    };
    Object.keys(view.layout).forEach(function (key) {
      var value = view.layout[key];
      if (key.slice(1, 5) === "axis") {
        layout[key] = Object.assign({
          color: ink, gridcolor: grid, linecolor: soft, zerolinecolor: soft, zerolinewidth: 1,
          automargin: true, ticks: "outside", tickcolor: soft, ticklen: 4, nticks: narrow || view.layout.rows > 1 ? 5 : 9,
          exponentformat: "power", showline: true
        }, value);
        layout[key].title = { text: value.title.text, standoff: 6, font: { size: 12 } };
      } else if (key === "shapes") {
        layout.shapes = value.map(function (shape) {
          var copy = Object.assign({}, shape, { fillcolor: colour(shape.role), line: { width: 0 } });
          delete copy.role;
          return copy;
        });
      } else if (key === "annotations") {
        layout.annotations = value.map(function (note) {
          var own = colour(note.role);
          var copy = Object.assign({}, note, { font: { color: own, size: 12 }, arrowcolor: own, arrowwidth: 1.2, bgcolor: paper, opacity: 0.92 });
          delete copy.role;
          return copy;
        });
      }
    });
    return { data: data, layout: layout };
  }

  function legend(box, canvas, view) {
    var groups = {};
    view.data.forEach(function (trace, index) {
      var key = trace.meta.group;
      if (key === "extreme") { return; }
      if (!groups[key]) { groups[key] = { traces: [], trace: trace, many: false }; }
      groups[key].traces.push(index);
    });
    box.textContent = "";
    if (Object.keys(groups).length < 2 || Object.keys(groups).length === view.layout.rows) { return; }
    Object.keys(groups).forEach(function (key) {
      var group = groups[key];
      var button = document.createElement("button");
      var swatch = document.createElement("i");
      swatch.style.borderTopColor = colour(group.trace.meta.role);
      swatch.style.borderTopStyle = group.trace.line.dash === "dash" ? "dashed" : "solid";
      button.type = "button";
      button.appendChild(swatch);
      button.appendChild(document.createTextNode(key));
      var visible = key in view.hidden ? !view.hidden[key] : group.trace.visible !== false;
      button.setAttribute("aria-pressed", String(visible));
      button.addEventListener("click", function () {
        visible = !visible;
        view.hidden[key] = !visible;
        button.setAttribute("aria-pressed", String(visible));
        Plotly.restyle(canvas, { visible: visible }, group.traces);
        if (view.layout.rows === 1) { Plotly.relayout(canvas, { "yaxis.autorange": true }); }
      });
      box.appendChild(button);
    });
  }

  function element(tag, name, text) {
    var made = document.createElement(tag);
    made.className = name;
    if (text) { made.textContent = text; }
    return made;
  }

  // One view into a new box; returns the box.
  function show(figure, view, width, named) {
    var box = element("div", "view");
    var name = [named ? view.case : "", view.caption].filter(Boolean).join(": ");
    if (name) { box.appendChild(element("p", "name", name)); }
    if (view.message) { box.appendChild(element("p", "message", view.message)); }
    figure.views.appendChild(box);
    if (!view.data.length) { return box; }
    var canvas = element("div", "canvas");
    var list = element("div", "legend");
    box.appendChild(canvas);
    box.appendChild(list);
    var drawn = drawing(view, width || canvas.clientWidth);
    Plotly.newPlot(canvas, drawn.data, drawn.layout, { displaylogo: false, displayModeBar: false, doubleClick: "reset" });
    legend(list, canvas, view);
    return box;
  }

  function clear(figure) {
    figure.views.querySelectorAll(".canvas").forEach(function (canvas) { Plotly.purge(canvas); });
    figure.views.textContent = "";
  }

  function chosen(figure) {
    var name = figure.caseBox ? figure.caseBox.value : figure.data[0].case;
    var stretch = figure.stretchBox ? figure.stretchBox.value : figure.data[0].stretch;
    var ofCase = figure.data.filter(function (view) { return view.case === name; });
    return ofCase.filter(function (view) { return view.stretch === stretch; })[0] || ofCase[0];
  }

  function draw(figure) {
    figure.drawn = true;
    // The height is kept while the plot is made again, so that the page does not jump.
    figure.views.style.minHeight = figure.views.offsetHeight + "px";
    clear(figure);
    show(figure, chosen(figure), 0, !figure.caseBox && figure.data[0].case !== "");
    figure.views.style.minHeight = "";
  }

  function drawn() { return figures.filter(function (figure) { return figure.drawn; }); }

  document.querySelectorAll("figure.plot").forEach(function (node) {
    var figure = {
      node: node, views: node.querySelector(".views"), drawn: false,
      data: JSON.parse(node.querySelector("script").textContent),
      caseBox: node.querySelector("select.case"), stretchBox: node.querySelector("select.stretch")
    };
    figure.data.forEach(function (view) { view.hidden = {}; });
    [figure.caseBox, figure.stretchBox].forEach(function (box) {
      if (box) { box.addEventListener("change", function () { draw(figure); }); }
    });
    figures.push(figure);
  });

  // What is in sight at once: a picture of the page that is taken as it opens shows it too.
  figures.forEach(function (figure) {
    if (figure.node.getBoundingClientRect().top < window.innerHeight) { draw(figure); }
  });

  if ("IntersectionObserver" in window) {
    var observer = new IntersectionObserver(function (entries) {
      entries.forEach(function (entry) {
        if (!entry.isIntersecting) { return; }
        observer.unobserve(entry.target);
        figures.forEach(function (figure) {
          if (figure.node === entry.target && !figure.drawn) { draw(figure); }
        });
      });
    }, { rootMargin: "600px" });
    figures.forEach(function (figure) { observer.observe(figure.node); });
  } else {
    figures.forEach(draw);
  }

  var width = window.innerWidth, timer = 0, printing = false;
  window.addEventListener("resize", function () {
    if (printing || window.innerWidth === width) { return; }
    width = window.innerWidth;
    clearTimeout(timer);
    timer = setTimeout(function () { drawn().forEach(draw); }, 150);
  });
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", function () {
    if (!printing) { drawn().forEach(draw); }
  });

  // On paper nobody can choose: the whole run of every case.
  window.addEventListener("beforeprint", function () {
    printing = true;
    figures.forEach(function (figure) {
      clear(figure);
      figure.data.forEach(function (view) {
        if (view.stretch === figure.data[0].stretch) { show(figure, view, PRINT_WIDTH, true); }
      });
    });
  });
  window.addEventListener("afterprint", function () {
    printing = false;
    figures.forEach(draw);
  });
})();
