"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const robot = document.getElementById("robot"), when = document.getElementById("when"), play = document.getElementById("play");
const style = name => getComputedStyle(document.documentElement).getPropertyValue(name) || "#666";
const colours = () => ["--after", "--before", "--good", "--fifth", "--accent", "--measured"].map(style);
let turn = 0.9, tilt = 0.35, closer = 1, running = true, last = 0, at = 0;

const low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
for (const frame of data.ends) for (let i = 0; i < frame.length; i++) {
  low[i % 3] = Math.min(low[i % 3], frame[i]);
  high[i % 3] = Math.max(high[i % 3], frame[i]);
}
const middle = low.map((x, i) => (x + high[i]) / 2);
const size = Math.max(...low.map((x, i) => high[i] - x), 1e-3);

function seen(x, y, z) {
  [x, y, z] = [x - middle[0], y - middle[1], z - middle[2]];
  const a = Math.cos(turn) * x - Math.sin(turn) * y, b = Math.sin(turn) * x + Math.cos(turn) * y;
  const scale = closer * 0.8 * robot.height / size;
  return [robot.width / 2 + scale * a, robot.height / 2 - scale * (Math.cos(tilt) * z + Math.sin(tilt) * b)];
}

function drawRobot(k) {
  const c = robot.getContext("2d"), f = data.ends[k];
  c.clearRect(0, 0, robot.width, robot.height);
  c.strokeStyle = style("--rule");
  c.lineWidth = 1;
  const step = size / 5, floor = low[2];
  for (let i = -5; i <= 5; i++) for (const [p, q] of [[[i, -5], [i, 5]], [[-5, i], [5, i]]]) {
    c.beginPath();
    c.moveTo(...seen(middle[0] + p[0] * step, middle[1] + p[1] * step, floor));
    c.lineTo(...seen(middle[0] + q[0] * step, middle[1] + q[1] * step, floor));
    c.stroke();
  }
  c.strokeStyle = style("--ink");
  c.lineWidth = 4;
  c.lineCap = "round";
  for (let i = 0; i < f.length; i += 6) {
    c.beginPath();
    c.moveTo(...seen(f[i], f[i + 1], f[i + 2]));
    c.lineTo(...seen(f[i + 3], f[i + 4], f[i + 5]));
    c.stroke();
  }
}

const short = v => String(+v.toPrecision(3)).replace("-", "−");

function drawCurve(canvas, time) {
  const p = data.panels[canvas.dataset.panel], c = canvas.getContext("2d"), left = 60, below = 24;
  // as many dots as the screen has, so that letters have their size on a narrow one too
  const sharp = window.devicePixelRatio || 1, wide = canvas.clientWidth, high = canvas.clientHeight;
  if (canvas.width !== Math.round(sharp * wide)) { canvas.width = Math.round(sharp * wide); canvas.height = Math.round(sharp * high); }
  c.setTransform(sharp, 0, 0, sharp, 0, 0);
  const values = p.curves.flatMap(([, y]) => y).filter(v => v !== null);
  const [min, max] = values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [1e99, -1e99]);
  const span = max > min ? max - min : 1, x0 = p.x[0], across = p.x[p.x.length - 1] - x0 || 1;
  const place = (x, y) => [left + (x - x0) / across * (wide - left - 8),
    (high - below) - (y - min) / span * (high - below - 10)];
  c.clearRect(0, 0, wide, high);
  c.fillStyle = style("--quiet");
  c.font = "13px sans-serif";
  const near = v => short(Math.abs(v) < 0.002 * span ? 0 : v); // a label of many digits would run into the curve
  for (const v of [min, max]) c.fillText(near(v), 2, place(x0, v)[1] + 4);
  c.fillText(`${p.across}: ${short(x0)} to ${short(x0 + across)}`, left, high - 4);
  p.curves.forEach(([, y], k) => {
    c.strokeStyle = colours()[k % 6];
    c.lineWidth = 1.5;
    c.beginPath();
    let down = false;
    y.forEach((v, i) => {
      if (v === null) { down = false; return; }
      down ? c.lineTo(...place(p.x[i], v)) : c.moveTo(...place(p.x[i], v));
      down = true;
    });
    c.stroke();
  });
  if (p.moves) {
    c.strokeStyle = style("--quiet");
    c.lineWidth = 1;
    c.beginPath();
    c.moveTo(...place(x0 + time, min));
    c.lineTo(...place(x0 + time, max));
    c.stroke();
  }
}

function show(k) {
  drawRobot(k);
  document.getElementById("now").textContent = `${data.time[k].toFixed(2)} s`;
  document.querySelectorAll("canvas.curve").forEach(each => drawCurve(each, data.time[k]));
}

function tick(now) {
  if (running) {
    at = (at + (now - last) / 1000) % Math.max(data.time[data.time.length - 1], 1e-3);
    let k = data.time.findIndex(t => t >= at);
    when.value = k < 0 ? 0 : k;
    show(+when.value);
  }
  last = now;
  requestAnimationFrame(tick);
}

const paintKeys = () => document.querySelectorAll(".key[data-of]").forEach(each => {
  each.style.color = colours()[each.dataset.of % 6];
});
paintKeys();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { paintKeys(); show(+when.value); });
play.onclick = () => { running = !running; play.textContent = running ? "Stop" : "Play"; };
when.oninput = () => { running = false; play.textContent = "Play"; at = data.time[+when.value]; show(+when.value); };
robot.onpointermove = e => {
  if (!e.buttons) return;
  turn += 0.01 * e.movementX;
  tilt = Math.max(-1.5, Math.min(1.5, tilt + 0.01 * e.movementY));
  show(+when.value);
};
robot.onwheel = e => { e.preventDefault(); closer *= Math.exp(-0.001 * e.deltaY); show(+when.value); };
if (matchMedia("(prefers-reduced-motion: reduce)").matches) play.onclick();
show(0);
requestAnimationFrame(now => { last = now; tick(now); });
