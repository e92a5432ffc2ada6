"use strict";
// What the scripts of all pages share: unpacking, plotly, colours that follow the page's scheme.
const shell = (() => {
  const byId = (id) => document.getElementById(id);
  const inflate = async (id) => {
    const bytes = Uint8Array.from(atob(byId(id).textContent.trim()), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
  };
  const able = typeof DecompressionStream !== "undefined"; // without it the picture stays
  const loadPlotly = async () => {
    const script = document.createElement("script");
    script.textContent = new TextDecoder().decode(await inflate("plotly"));
    document.head.append(script);
    script.remove();
  };
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const clear = (hex, alpha) => hex + Math.round(255 * alpha).toString(16).padStart(2, "0");
  const config = { displayModeBar: false, responsive: true, doubleClick: false };
  const axisStyle = (title) => ({
    title: { text: title, standoff: 8, font: { size: 12.5 } }, gridcolor: colour("rule"), zerolinecolor: colour("rule"),
    linecolor: colour("quiet"), tickfont: { size: 11.5, color: colour("quiet") }, automargin: true, fixedrange: true, nticks: 6,
  });
  const base = () => ({
    paper_bgcolor: colour("paper"), plot_bgcolor: colour("paper"), showlegend: false, hovermode: "x",
    font: { family: getComputedStyle(document.body).fontFamily, color: colour("ink"), size: 12.5 },
    hoverlabel: { bgcolor: colour("soft"), bordercolor: colour("rule"), font: { color: colour("ink") } },
    dragmode: false,
  });
  const draw = (id, traces, layout, label) => {
    byId(id).setAttribute("aria-label", label);
    return Plotly.react(byId(id), traces, layout, config);
  };
  // Draws in place of the picture, which comes back where that fails; again for another scheme, and for paper.
  const show = (drawAll) => {
    const swap = (drawn) => {
      document.querySelectorAll("#fallback, .fallback").forEach((part) => { part.hidden = drawn; });
      document.querySelectorAll("#plots, figure.drawing").forEach((part) => { part.hidden = !drawn; });
    };
    swap(true);
    try {
      drawAll();
    } catch (error) {
      swap(false);
      throw error;
    }
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawAll);
    addEventListener("beforeprint", () => {
      document.querySelectorAll("details").forEach((part) => { part.open = true; });
      document.documentElement.dataset.print = "";
      drawAll();
    });
    addEventListener("afterprint", () => { delete document.documentElement.dataset.print; drawAll(); });
  };
  return { byId, inflate, able, loadPlotly, colour, clear, axisStyle, base, draw, show };
})();
