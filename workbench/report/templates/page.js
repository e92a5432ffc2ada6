(async () => {
  const { byId, inflate, able, loadPlotly, colour, clear, axisStyle, base, draw, show } = shell;
  if (!able) return;

  const data = JSON.parse(byId("values").textContent);
  const block = new Uint8Array(await inflate("curves"));
  await loadPlotly();

  // A curve is zigzag differences of 32-bit integers, byte planes one after the other.
  const curve = (c) => {
    if (!c.values) {
      const { at, n, step } = c;
      c.values = new Float64Array(n);
      for (let i = 0, sum = 0; i < n; i++) {
        const z = block[at + i] | (block[at + n + i] << 8) | (block[at + 2 * n + i] << 16) | (block[at + 3 * n + i] << 24);
        sum += (z >>> 1) ^ -(z & 1);
        c.values[i] = sum * step;
      }
    }
    return c.values;
  };

  // Least and greatest of each pixel's stretch between times t0 and t1; null inside gaps.
  const seen = (c, t0, t1, pixels, factor, gaps) => {
    const v = curve(c), x = [], y = [];
    const from = Math.max(0, Math.floor(t0 / c.dt) - 1), to = Math.min(v.length, Math.ceil(t1 / c.dt) + 2);
    const length = Math.max(1, Math.floor((to - from) / pixels));
    let gap = 0;
    const put = (i) => {
      const t = i * c.dt;
      while (gap < gaps.length && gaps[gap][1] < t) gap++;
      x.push(t);
      y.push(gap < gaps.length && gaps[gap][0] <= t ? null : factor * v[i]);
    };
    for (let i = from; i < to; i += length) {
      let least = i, most = i;
      for (let j = i + 1; j < Math.min(to, i + length); j++) {
        if (v[j] < v[least]) least = j;
        if (v[j] > v[most]) most = j;
      }
      put(Math.min(least, most));
      if (least !== most) put(Math.max(least, most));
    }
    return { x, y };
  };

  const state = { ...data.start, range: null };
  const opening = () => data.recordings[state.recording].axes[state.axis]?.window ?? null;
  state.range = opening();
  byId("pick-recording").value = state.recording;
  byId("pick-axis").value = state.axis;
  const coarse = matchMedia("(pointer: coarse)").matches;
  const line = (when) => ({
    color: colour(when),
    width: when === "measured" ? 4 : 1.5,
    dash: when === "before" ? "6px,3px" : "solid",
  });
  const runs = data.after ? ["before", "after"] : ["before"];
  const round = (v) => (v === null || v === undefined ? "unknown" : Number(v.toPrecision(3)).toString());

  const drawTime = () => {
    const recording = data.recordings[state.recording], view = recording.axes[state.axis], axis = data.axes[state.axis];
    const div = byId("plot-time"), signals = view ? ["position", "torque"].filter((s) => view[s]) : [];
    const [t0, t1] = state.range || [0, recording.duration];
    const pixels = Math.max(300, div.clientWidth - 80), traces = [];
    const layout = {
      ...base(), height: 40 + 290 * Math.max(1, signals.length), margin: { l: 64, r: 8, t: 8, b: 44 },
      dragmode: coarse ? false : "zoom", shapes: [],
      xaxis: { ...axisStyle("time [s]"), range: [t0, t1], fixedrange: coarse, anchor: `y${2 * signals.length}`, nticks: 9 },
    };
    const total = signals.length, words = [];
    signals.forEach((signal, i) => {
      const { curves, noise, rmse } = view[signal], { unit, residual_unit, residual_factor } = axis[signal];
      const top = 1 - i / total, ys = [2 * i + 1, 2 * i + 2].map((n) => (n === 1 ? "y" : `y${n}`));
      const add = (c, when, y, factor, u) => c && traces.push({
        ...seen(c, t0, t1, pixels, factor, recording.gaps), type: "scatter", mode: "lines", line: line(when), yaxis: y,
        name: { measured: "measured", before: data.after ? "as given" : "simulated", after: "effects added" }[when],
        hovertemplate: `%{y:.4~g} ${u}`, connectgaps: false,
      });
      add(curves.measured, "measured", ys[0], 1, unit);
      runs.forEach((when) => add(curves[when], when, ys[0], 1, unit));
      runs.forEach((when) => add(curves[`${when}_residual`], when, ys[1], residual_factor, residual_unit));
      layout[`yaxis${2 * i + 1}`.replace(/axis1$/, "axis")] = { ...axisStyle(`${signal} [${unit}]`), domain: [top - 0.53 / total, top] };
      layout[`yaxis${2 * i + 2}`] = {
        ...axisStyle(`residual [${residual_unit}]`), domain: [top - 0.95 / total, top - 0.59 / total], nticks: 4,
      };
      if (noise !== null) layout.shapes.push({
        type: "rect", xref: "paper", x0: 0, x1: 1, yref: ys[1], y0: -2 * noise * residual_factor, y1: 2 * noise * residual_factor,
        fillcolor: clear(colour("noise"), 0.3), line: { width: 0 }, layer: "below",
      }, ...[-2, 2].map((k) => ({
        type: "line", xref: "paper", x0: 0, x1: 1, yref: ys[1], y0: k * noise * residual_factor, y1: k * noise * residual_factor,
        line: { color: colour("ink"), width: 1, dash: "1px,3px" },
      })));
      const left = runs.map((when) => round(rmse[when])).join(" before and ") + (data.after ? " after" : "");
      words.push(`${signal} residual ${left} ${unit} RMS, noise ${round(noise)} ${unit}`);
    });
    byId("window").textContent = `${round(t0)} to ${round(t1)} s of ${round(recording.duration)} s`;
    draw("plot-time", traces, layout, `${axis.name} in recording ${recording.name}, measured and simulated against time: ${words.join("; ")}.`);
  };

  const small = (x, y) => ({ ...base(), height: 250, margin: { l: 60, r: 8, t: 14, b: 44 }, xaxis: axisStyle(x), yaxis: axisStyle(y) });

  const drawAgainst = (signal, quantity) => {
    const id = `plot-${signal}-${quantity}`, axis = data.axes[state.axis], { against, residual_unit, residual_factor } = axis[signal];
    const traces = [], scale = (values) => values.map((v) => residual_factor * v);
    byId(id).hidden = !against[quantity].before.centre.length;
    if (byId(id).hidden) return;
    for (const when of runs) {
      const { centre, median, low, high } = against[quantity][when], { color } = line(when);
      const edge = { x: centre, type: "scatter", mode: "lines", line: { width: 0 }, hoverinfo: "skip" };
      traces.push({ ...edge, y: scale(low) }, { ...edge, y: scale(high), fill: "tonexty", fillcolor: clear(color, 0.18) });
      traces.push({
        x: centre, y: scale(median), type: "scatter", mode: "lines+markers", line: line(when), hovertemplate: `%{y:.3~g} ${residual_unit}<extra></extra>`,
        marker: { size: 5, symbol: when === "before" ? "circle" : "square", color },
      });
    }
    const unit = {
      speed: axis.speed_unit, position: axis.position.unit, load: axis.torque.unit, acceleration: `${axis.speed_unit}²`,
    }[quantity];
    draw(id, traces, small(`${quantity} [${unit}]`, `${signal} residual [${residual_unit}]`),
      `${axis.name}: median ${signal} residual against ${quantity}, with quartiles.`);
  };

  const drawSpectrum = (signal) => {
    const id = `plot-${signal}-spectrum`, axis = data.axes[state.axis], { spectrum, noise_density, unit } = axis[signal];
    byId(id).hidden = !spectrum.before.f.length;
    if (byId(id).hidden) return;
    const traces = runs.map((when) => ({
      x: spectrum[when].f, y: spectrum[when].a, type: "scatter", mode: "lines", line: line(when),
      hovertemplate: `%{y:.3~g} ${unit}/√Hz<extra></extra>`,
    }));
    const layout = small("frequency [Hz]", `${signal} residual [${unit}/√Hz]`);
    for (const a of [layout.xaxis, layout.yaxis]) Object.assign(a, { type: "log", dtick: 1, exponentformat: "power", showexponent: "all" });
    layout.xaxis.exponentformat = "none";
    if (noise_density) layout.shapes = [{
      type: "line", xref: "paper", x0: 0, x1: 1, y0: noise_density, y1: noise_density,
      line: { color: colour("noise"), width: 2, dash: "dot" },
    }];
    draw(id, traces, layout, `${axis.name}: spectrum of the ${signal} residual beside the noise floor.`);
  };

  const drawAll = () => {
    drawTime();
    for (const signal of ["torque", "position"]) {
      for (const quantity of Object.keys(data.axes[state.axis][signal].against)) drawAgainst(signal, quantity);
      drawSpectrum(signal);
    }
  };

  const drawShapes = () => data.shapes.forEach((s, i) => {
    const { color } = line("before"), edge = { x: s.grid, type: "scatter", mode: "lines", line: { width: 0 }, hoverinfo: "skip" };
    draw(`plot-shape-${i}`, [
      { ...edge, y: s.low }, { ...edge, y: s.high, fill: "tonexty", fillcolor: clear(color, 0.2) },
      { x: s.grid, y: s.seen, type: "scatter", mode: "markers", marker: { size: 6, color: colour("measured") }, hoverinfo: "skip" },
      { x: s.grid, y: s.torque, type: "scatter", mode: "lines", line: line("before"), hovertemplate: `%{y:.3~g} ${s.unit}<extra></extra>` },
    ], small(s.x, s.y), s.about);
  });

  const look = (t0, t1) => {
    const end = data.recordings[state.recording].duration, width = Math.min(end, Math.max(t1 - t0, 0.02));
    const start = Math.min(Math.max(0, t0), end - width);
    state.range = width >= end ? null : [start, start + width];
    drawTime();
  };
  const moves = {
    in: (a, w) => [a + w / 4, a + (3 * w) / 4], out: (a, w) => [a - w / 2, a + 1.5 * w],
    left: (a, w) => [a - w / 2, a + w / 2], right: (a, w) => [a + w / 2, a + 1.5 * w], all: () => [0, Infinity],
  };
  show(() => { drawAll(); drawShapes(); });
  document.querySelectorAll("[data-zoom]").forEach((button) => button.addEventListener("click", () => {
    const [a, b] = state.range || [0, data.recordings[state.recording].duration];
    look(...moves[button.dataset.zoom](a, b - a));
  }));
  byId("plot-time").on("plotly_relayout", (event) => {
    const range = event["xaxis.range"] || [event["xaxis.range[0]"], event["xaxis.range[1]"]];
    if (range[0] !== undefined) look(Number(range[0]), Number(range[1]));
  });
  byId("plot-time").on("plotly_doubleclick", () => look(0, Infinity));
  byId("pick-recording").addEventListener("change", (e) => {
    state.recording = Number(e.target.value);
    state.range = opening();
    drawTime();
  });
  byId("pick-axis").addEventListener("change", (e) => { state.axis = Number(e.target.value); drawAll(); });
  document.documentElement.dataset.drawn = "yes";
})();
