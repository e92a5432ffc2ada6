"use strict";
// What the page does by itself: colours by the scheme, zoom by buttons, and the moving picture.
(() => {
  const byId = (id) => document.getElementById(id);
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const looks = JSON.parse(byId("looks").textContent);

  const whenReady = setInterval(() => {
    const page = window.Bokeh?.documents?.[0];
    const named = (name) => page?.get_model_by_name(name);
    if (!named("motion") || !named("cursor") || !named("map colours")) return;
    clearInterval(whenReady);
    paint(page);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { paint(page); stage.draw(); });
    stage.start(named("motion"), named("cursor"), timeOf(page));
    zoom(timeOf(page));
    mapOf(page).on_event("tap", () => {
      const top = (id) => byId(id).getBoundingClientRect().top; // many sliders in a low window hide the curves
      const goal = top("plots") - top("curves") < innerHeight / 2 ? "curves" : "plots";
      byId(goal).scrollIntoView({ behavior: calm ? "auto" : "smooth" });
    });
    name();
    setInterval(name, 500); // widgets come and go, and say their numbers anew
    document.documentElement.dataset.ready = "yes";
  }, 50);

  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const mapOf = (page) => models(page).find((m) => m.type === "Figure" && m.y_range.type === "FactorRange");
  const models = (page) => [...page._all_models.values()];
  const timeOf = (page) => models(page).find((m) => m.type === "Figure" && m.tags.includes(page.get_model_by_name("motion"))).x_range;

  // Bokeh draws on a canvas, which style sheets do not reach: every model is told its colours.
  const paint = (page) => {
    const ink = colour("ink"), quiet = colour("quiet"), rule = colour("rule");
    for (const m of models(page)) {
      if (m.type.endsWith("Axis")) {
        set(m, {
          axis_label_text_color: ink, major_label_text_color: quiet, axis_line_color: quiet, major_tick_line_color: quiet,
        });
      } else if (m.type === "Grid") set(m, { grid_line_color: rule });
      else if (m.type === "LinearColorMapper") {
        const steps = 48, ends = [colour("soft"), colour("before")].map(rgb);
        set(m, { palette: Array.from({ length: steps }, (_, k) => mix(ends[0], ends[1], k / (steps - 1))) });
      }
      for (const tag of m.tags ?? []) {
        const [what, name] = String(tag).split(":");
        if (what === "line" || what === "fill") set(m, { [`${what}_color`]: colour(name) });
      }
    }
  };
  const set = (model, values) => model.setv(values, { sync: false }); // the server need not know
  const rgb = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
  const mix = (a, b, part) => `#${a.map((x, k) => Math.round(x + part * (b[k] - x)).toString(16).padStart(2, "0")).join("")}`;

  const zoom = (range) => {
    const told = () => {
      const [a, b] = [range.start, range.end];
      byId("window").textContent = `${a.toFixed(2)} to ${b.toFixed(2)} s`;
    };
    range.connect(range.change, told);
    told();
    const moves = {
      in: (a, w) => [a + w / 4, a + (3 * w) / 4], out: (a, w) => [a - w / 2, a + 1.5 * w],
      left: (a, w) => [a - w / 2, a + w / 2], right: (a, w) => [a + w / 2, a + 1.5 * w], all: () => [-Infinity, Infinity],
    };
    const look = (name) => {
      const [low, high] = range.bounds ?? [0, range.end], [a, b] = moves[name](range.start, range.end - range.start);
      const width = Math.min(high - low, Math.max(b - a, 0.02)), start = Math.min(Math.max(low, a), high - width);
      range.setv({ start, end: start + width });
    };
    for (const button of document.querySelectorAll("[data-zoom]")) button.addEventListener("click", () => look(button.dataset.zoom));
    byId("plots").addEventListener("dblclick", () => look("all"));
  };

  // Panel writes the words of a checkbox and of a slider beside them, and gives neither a name.
  const every = (selector, root = document) => [...root.querySelectorAll(selector),
    ...[...root.querySelectorAll("*")].flatMap((e) => (e.shadowRoot ? every(selector, e.shadowRoot) : []))];
  const wordsIn = (node) => (["STYLE", "LINK", "SCRIPT"].includes(node.tagName) ? "" : node.nodeType === Node.TEXT_NODE
    ? node.textContent : [...node.childNodes, ...(node.shadowRoot?.childNodes ?? [])].map(wordsIn).join(" "));
  const tell = (e, name, value) => { if (value && e.getAttribute(name) !== value) e.setAttribute(name, value); };
  const name = () => {
    for (const box of every("input[type=checkbox]")) if (!box.labels.length) tell(box, "aria-label", wordsIn(box.getRootNode()).trim());
    for (const track of every(".noUi-target")) {
      const handle = track.querySelector(".noUi-handle"), value = Number(track.noUiSlider?.get(true));
      const whole = track.getRootNode().host?.getRootNode(); // title and number field, then the track
      const words = [...whole.children].map((e) => wordsIn(e).trim()).find(Boolean)?.replace(/:$/, "");
      for (const e of [handle, ...every(".bk-spin-wrapper input", whole)]) tell(e, "aria-label", words);
      if (!Number.isFinite(value)) continue;
      tell(handle, "aria-valuenow", value.toPrecision(4));
      tell(handle, "aria-valuetext", value.toPrecision(4));
    }
  };

  // The links in space, seen from a camera that turns about their middle.
  const stage = (() => {
    const canvas = byId("stage"), pen = canvas.getContext("2d");
    const view = { azimuth: -1.2, elevation: 0.2, zoom: 1 };
    let scene = null, time = 0, playing = false, last = 0, cursor = null, range = null, facing = null;

    const read = (data) => {
      const t = data.t, facts = data.scene;
      if (!t?.length || !facts) return null;
      const count = facts[0], runs = {};
      for (const name of ["measured", "before", "after"]) {
        if (!data[`${name}_0_0`]) continue;
        runs[name] = Array.from({ length: count }, (_, s) => Array.from({ length: 6 }, (_, c) => data[`${name}_${s}_${c}`]));
      }
      const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
      for (const segment of runs.measured) segment.forEach((values, c) => {
        for (const v of values) { low[c % 3] = Math.min(low[c % 3], v); high[c % 3] = Math.max(high[c % 3], v); }
      });
      const middle = low.map((x, k) => (x + high[k]) / 2), size = Math.max(Math.hypot(...low.map((x, k) => high[k] - x)), 1e-3);
      return { t, count, tip: facts[1], azimuth: facts[2], radius: Array.from({ length: count }, (_, s) => facts[3 + s]), runs, middle, size, floor: low[2] };
    };

    const place = () => { // the row before the moment, and how far it is to the next one
      const t = scene.t;
      let a = 0, b = t.length - 1;
      while (b - a > 1) { const m = (a + b) >> 1; if (t[m] <= time) a = m; else b = m; }
      return [a, Math.min(1, Math.max(0, (time - t[a]) / (t[a + 1] - t[a] || 1)))];
    };

    const camera = () => {
      const { azimuth: a, elevation: e } = view, box = canvas.getBoundingClientRect();
      const right = [-Math.sin(a), Math.cos(a), 0], up = [-Math.cos(a) * Math.sin(e), -Math.sin(a) * Math.sin(e), Math.cos(e)];
      const out = [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)];
      const scale = (0.92 * view.zoom * Math.min(box.width, box.height * 1.2)) / scene.size, far = 4 * scene.size;
      const dot = (p, v) => p[0] * v[0] + p[1] * v[1] + p[2] * v[2];
      return (p) => {
        const d = p.map((x, k) => x - scene.middle[k]), depth = dot(d, out), near = far / Math.max(far - depth, 0.1 * far);
        return { x: box.width / 2 + scale * near * dot(d, right), y: box.height / 2 - scale * near * dot(d, up), depth, size: scale * near };
      };
    };

    const draw = () => {
      const box = canvas.getBoundingClientRect(), dense = devicePixelRatio || 1;
      if (canvas.width !== Math.round(box.width * dense) || canvas.height !== Math.round(box.height * dense)) {
        canvas.width = Math.round(box.width * dense);
        canvas.height = Math.round(box.height * dense);
      }
      pen.setTransform(dense, 0, 0, dense, 0, 0);
      pen.clearRect(0, 0, box.width, box.height);
      if (!scene) return;
      const see = camera(), [row, part] = place();
      const stroke = (from, to, style, width, alpha = 1, dash = []) => {
        pen.globalAlpha = alpha; pen.strokeStyle = style; pen.lineWidth = width; pen.lineCap = "round"; pen.setLineDash(dash);
        pen.beginPath(); pen.moveTo(from.x, from.y); pen.lineTo(to.x, to.y); pen.stroke();
      };
      ground(see, stroke);
      const model = scene.runs.after ? "after" : "before", more = Number(byId("exaggerate").value);
      const at = (name, s) => scene.runs[name][s].map((v) => v[row] + part * ((v[row + 1] ?? v[row]) - v[row]));
      const parts = [], deep = {}; // the model's part of a link right over the measured one
      for (const name of ["measured", model]) {
        if (!scene.runs[name]) continue;
        for (let s = 0; s < scene.count; s++) {
          let p = at(name, s);
          if (name !== "measured" && more > 1) { const real = at("measured", s); p = p.map((x, k) => real[k] + more * (x - real[k])); }
          const from = see(p.slice(0, 3)), to = see(p.slice(3));
          parts.push({ name, from, to, s, depth: deep[s] ??= (from.depth + to.depth) / 2 });
        }
      }
      trail("measured", see, row, "measured", 4);
      trail(model, see, row, looks[model].colour, 1.5);
      parts.sort((a, b) => a.depth - b.depth);
      for (const { name, from, to, s } of parts) {
        const width = Math.max(2 * scene.radius[s] * (from.size + to.size) / 2, 5);
        if (name === "measured") {
          stroke(from, to, colour("quiet"), width + 2, 0.55);
          stroke(from, to, colour("measured"), width);
        } else {
          const style = colour(looks[name].colour);
          stroke(from, to, style, Math.max(0.34 * width, 3), 0.95);
          pen.globalAlpha = 1; pen.fillStyle = style;
          for (const p of [from, to]) { pen.beginPath(); pen.arc(p.x, p.y, Math.max(0.3 * width, 4), 0, 7); pen.fill(); }
        }
      }
      pen.globalAlpha = 1;
    };

    const ground = (see, stroke) => {
      const s = scene.size, step = 10 ** Math.floor(Math.log10(s)) / (s / 10 ** Math.floor(Math.log10(s)) < 2.5 ? 4 : 2);
      const reach = 3, style = colour("rule");
      const [x, y] = scene.middle.map((v) => Math.round(v / step) * step), z = scene.floor - 0.04 * s;
      for (let k = -reach; k <= reach; k++) {
        stroke(see([x + k * step, y - reach * step, z]), see([x + k * step, y + reach * step, z]), style, 1);
        stroke(see([x - reach * step, y + k * step, z]), see([x + reach * step, y + k * step, z]), style, 1);
      }
    };

    const trail = (name, see, row, style, width) => { // where the tip has been in the last half second
      const ends = scene.runs[name]?.[scene.tip];
      if (!ends) return;
      pen.globalAlpha = 0.7; pen.strokeStyle = colour(style); pen.lineWidth = width; pen.setLineDash([]);
      pen.beginPath();
      for (let k = row; k >= 0 && scene.t[row] - scene.t[k] < 0.5; k--) {
        const p = see([ends[3][k], ends[4][k], ends[5][k]]);
        if (k === row) pen.moveTo(p.x, p.y); else pen.lineTo(p.x, p.y);
      }
      pen.stroke();
    };

    const goTo = (t, moved = true) => {
      time = t;
      byId("clock").textContent = `${t.toFixed(3)} s`;
      if (moved) byId("moment").value = t;
      cursor.data.x[0] = t;
      cursor.change.emit(); // in place: nor this
      draw();
    };

    const frame = (now) => {
      if (!playing) return;
      const speed = Number(byId("speed").value), end = Math.min(range.end, scene?.t.at(-1) ?? 0);
      let t = time + speed * Math.min(now - last, 100) / 1000;
      if (t >= end || t < range.start) t = Math.max(0, range.start); // what the curves show, over and over
      last = now;
      goTo(t);
      requestAnimationFrame(frame);
    };
    const play = (on) => {
      playing = on && scene !== null;
      byId("play").textContent = playing ? "Pause" : "Play";
      byId("play").setAttribute("aria-pressed", String(playing));
      if (playing) { last = performance.now(); requestAnimationFrame(frame); }
    };
    const turn = (across, along) => {
      view.azimuth += across;
      view.elevation = Math.min(1.5, Math.max(-0.4, view.elevation + along));
      draw();
    };

    const start = (motion, itsCursor, itsRange) => {
      cursor = itsCursor;
      range = itsRange;
      const update = () => {
        scene = read(motion.data);
        byId("key-after").hidden = !scene?.runs.after;
        document.body.dataset.empty = scene ? "no" : "yes";
        if (!scene) return;
        if (facing !== scene.azimuth) { facing = scene.azimuth; view.azimuth = facing + 0.35; }
        byId("moment").max = scene.t.at(-1);
        if (time > scene.t.at(-1)) goTo(0); else draw();
      };
      motion.connect(motion.properties.data.change, update);
      update();
      byId("play").addEventListener("click", () => play(!playing));
      byId("moment").addEventListener("input", (e) => { play(false); goTo(Number(e.target.value), false); });
      byId("exaggerate").addEventListener("change", draw);
      let held = null;
      canvas.addEventListener("pointerdown", (e) => { held = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
      canvas.addEventListener("pointermove", (e) => {
        if (!held) return;
        turn((held[0] - e.clientX) / 120, (e.clientY - held[1]) / 160);
        held = [e.clientX, e.clientY];
      });
      for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { held = null; });
      canvas.addEventListener("wheel", (e) => {
        if (!e.ctrlKey) return;
        e.preventDefault();
        view.zoom = Math.min(6, Math.max(0.3, view.zoom * Math.exp(-e.deltaY / 400)));
        draw();
      }, { passive: false });
      canvas.addEventListener("keydown", (e) => {
        const moves = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
        if (moves[e.key]) turn(...moves[e.key]);
        else if (e.key === "+" || e.key === "-") { view.zoom *= e.key === "+" ? 1.15 : 1 / 1.15; draw(); } else if (e.key === " ") play(!playing);
        else return;
        e.preventDefault();
      });
      new ResizeObserver(draw).observe(canvas);
    };
    return { start, draw };
  })();
})();
