// What the HTML of this app calls: messages to the app, places on pictures, clicks that survive an update.

// Sends `verb:argument` through the hidden text field; the number at the end makes equal messages differ.
window.gwInbox = this.dataset.inbox;
window.gwSend = message => {
  const row = document.querySelector(`label[for="${gwInbox}"]`).closest('.mantine-Flex-root');
  const input = row.querySelector('input'), now = Math.floor(performance.timeOrigin * 1000 + performance.now() * 1000);
  // React hears of a value only when it was set behind its back.
  Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set.call(input, `${message}:${now}`);
  input.dispatchEvent(new Event('input', {bubbles: true}));
};

// Where the pointer is on an SVG, in its own units.
window.gwAt = (svg, event) => {
  const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
  return (place.x - 0.5).toFixed(1) + ',' + (place.y - 0.5).toFixed(1);
};

// A page that connects again runs this again; it listens once.
if (!window.gwHeld) {
  window.gwHeld = {};
  // What is pressed may be put on the page anew before it is released: browsers then see no click.
  const clickable = event => event.target.closest && event.target.closest('[onclick]');
  window.addEventListener('pointerdown', event => { gwHeld.on = clickable(event); }, true);
  window.addEventListener('pointerup', event => {
    const was = gwHeld.on, now = clickable(event);
    if (was && now && !was.isConnected && was.getAttribute('onclick') === now.getAttribute('onclick'))
      now.dispatchEvent(new MouseEvent('click', {bubbles: true, clientX: event.clientX, clientY: event.clientY}));
  }, true);
  // viser's dialogs know no Escape.
  window.addEventListener('keydown', event => {
    if (event.key === 'Escape') document.querySelector('[role=dialog]:has(.gw-keylist) button')?.click();
  });
  // Arrows belong to the slider or tab that has the focus; above the body viser would fly the camera by them.
  document.body.addEventListener('keydown', event => {
    if (event.key.startsWith('Arrow') && event.target.closest('[role=slider],[role=tab]')) event.stopPropagation();
  });
}
