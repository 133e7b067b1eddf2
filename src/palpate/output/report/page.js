"use strict";
// Curves and residuals of one condition at a time; the page's own figures stay for print and without scripts.
(() => {
  const sets = JSON.parse(document.getElementById("curves").textContent);
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  function layout(x, y) {
    const line = colour("--line"), ink = colour("--ink");
    const axis = (text) => ({title: {text}, gridcolor: line, zerolinecolor: colour("--soft"), linecolor: ink});
    return {
      xaxis: axis(x), yaxis: axis(y), paper_bgcolor: colour("--paper"), plot_bgcolor: colour("--paper"),
      font: {color: ink, size: 13}, margin: {l: 58, r: 12, t: 10, b: 48}, legend: {orientation: "h", y: 1.02, yanchor: "bottom"},
      hovermode: "closest",
    };
  }
  const config = {responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d", "toImage"]};
  const looks = () => ({
    recorded: {mode: "markers", marker: {color: colour("--ink"), size: 5, symbol: "circle-open"}, name: "recorded, mean"},
    base: {mode: "lines", line: {color: colour("--base"), width: 2, dash: "dash"}, name: "base model"},
    accepted: {mode: "lines", line: {color: colour("--bad"), width: 2}, name: "accepted model"},
  });

  function draw(block) {
    const found = sets[block.dataset.set][block.querySelector("select.condition").value];
    const over = block.querySelector("select.over").value, look = looks(), soft = colour("--soft");
    const inDepth = found.unit === "nm" && found.drive === "load" && found.driven.length > 0;
    const traces = found.tests.map((test, k) => ({
      x: inDepth ? test.depth : test.time, y: inDepth || found.unit === "mN" ? test.load : test.depth, mode: "lines",
      line: {color: soft, width: .8}, opacity: .7, name: found.tests.length > 1 ? "tests" : "test", text: test.name,
      legendgroup: "tests", showlegend: k === 0, hovertemplate: "%{text}: %{x}, %{y}<extra></extra>",
    }));
    for (const [name, values] of Object.entries(found.curve)) {
      traces.push({...look[name], x: inDepth ? values : found.time, y: inDepth ? found.driven : values});
    }
    const labels = inDepth ? ["depth [nm]", "load [mN]"] : ["time [s]", found.unit === "mN" ? "load [mN]" : "depth [nm]"];
    Plotly.react(block.querySelector(".plot.curve"), traces, layout(...labels), config);

    const axes = {time: [found.time, "time [s]"], drive: [found.driven, `${found.drive} [${found.drive === "load" ? "mN" : "nm"}]`],
      response: [found.curve.recorded, found.unit === "nm" ? "depth [nm]" : "load [mN]"]};
    const [x, title] = axes[over], left = [];
    if (found.left.band && over === "time") {
      left.push({x: [...x, ...[...x].reverse()], y: [...found.left.band, ...[...found.left.band].reverse().map((v) => v === null ? null : -v)],
        fill: "toself", mode: "none", fillcolor: colour("--line"), name: "noise and scatter, 95 %", hoverinfo: "skip"});
    }
    for (const name of ["base", "accepted"]) if (found.left[name]) left.push({...look[name], x, y: found.left[name]});
    Plotly.react(block.querySelector(".plot.residual"), left, layout(title, `recorded − simulated [${found.unit}]`), config);
  }

  const blocks = [...document.querySelectorAll(".interactive")];
  for (const block of blocks) {
    block.classList.add("live");
    block.addEventListener("change", () => draw(block));
    draw(block);
  }
  dark.addEventListener("change", () => blocks.forEach(draw));
  addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((each) => { each.open = true; }));
})();
