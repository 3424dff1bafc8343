// Where the scene is drawn without a GPU: fewer pixels while things move, all of them at rest.
//
// What software draws takes time in proportion to its pixels; at full resolution it takes more of the processor than
// planning does, and the page waits for each frame. viser's own rule for slow pages gives up a quarter of the resolution
// only, and keeps it so at rest; it is overruled. Pages with a GPU, and those whose address sets fixedDpr, are left alone.
window.gwPace = moving => {
  const gl = document.querySelector('canvas[data-engine]')?.getContext('webgl2');
  const root = window.__viserMutable?.scene?.__r3f?.root;
  if (!gl || !root || new URLSearchParams(location.search).has('fixedDpr')) return;
  const told = gl.getExtension('WEBGL_debug_renderer_info');
  const renderer = String(gl.getParameter(told ? told.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  if (!/swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer)) return;
  const keep = state => { if (state.viewport.dpr !== gwPace.dpr) state.setDpr(gwPace.dpr); };
  if (!gwPace.dpr) root.subscribe(keep);
  gwPace.dpr = devicePixelRatio * (moving ? 0.4 : 1);
  keep(root.getState());
};
