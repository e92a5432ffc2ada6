(async () => {
  const { inflate, able, loadPlotly, colour, clear, axisStyle, base, draw, show } = shell;
  if (!able) return;

  const panels = JSON.parse(new TextDecoder().decode(await inflate("values")));
  await loadPlotly();

  // Stretches without a gap.
  const whole = (low, high) => {
    const out = [];
    for (let i = 0, from = 0; i <= low.length; i++) {
      if (i < low.length && low[i] !== null && high[i] !== null) continue;
      if (i > from) out.push([from, i]);
      from = i + 1;
    }
    return out;
  };

  const traces = (curve, yaxis) => {
    const { name, width, dash, x, v, low, high } = curve, color = colour(curve.colour), out = [];
    const common = { x, yaxis, name, type: "scatter", connectgaps: false };
    for (const [from, to] of low ? whole(low, high) : []) { // a band ends where it is unknown
      const edge = { ...common, x: x.slice(from, to), mode: "lines", line: { width: 0 }, hoverinfo: "skip" };
      out.push({ ...edge, y: low.slice(from, to) }, {
        ...edge, y: high.slice(from, to), fill: "tonexty", fillcolor: clear(color, 0.3),
      });
    }
    if (v) out.push({
      ...common, y: v, hovertemplate: "%{y:.4~g}",
      ...(dash === "dot" ? { mode: "markers", marker: { size: width, color } } : { mode: "lines", line: { width, dash, color } }),
    });
    return out;
  };

  const height = 210;
  const drawPanel = (panel, i) => {
    const count = panel.rows.length, gap = 0.06;
    const layout = { ...base(), height: 60 + height * count, margin: { l: 64, r: 10, t: 8, b: 46 } };
    layout.xaxis = { ...axisStyle(panel.x), anchor: count > 1 ? `y${count}` : "y" };
    if (panel.log) Object.assign(layout.xaxis, { type: "log", dtick: 1, minor: { ticks: "outside", ticklen: 3 } });
    const all = panel.rows.flatMap((row, k) => {
      const key = k ? `yaxis${k + 1}` : "yaxis", top = 1 - k / count;
      layout[key] = { ...axisStyle(row.y), domain: [top - 1 / count + (k + 1 < count ? gap : 0), top] };
      if (row.log) Object.assign(layout[key], { type: "log", exponentformat: "power" });
      if (row.range) layout[key].range = row.range;
      return row.curves.flatMap((curve) => traces(curve, k ? `y${k + 1}` : "y"));
    });
    draw(`plot-${i}`, all, layout, panel.summary);
  };

  show(() => panels.forEach(drawPanel));
  document.documentElement.dataset.drawn = "yes";
})();
