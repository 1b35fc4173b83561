// Files that are dropped anywhere on the page.

/** @param {(file: File | undefined) => void} taken hears of the first */
export function takeDrops(taken) {
  const carries = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes('Files') ?? false;
  const mark = (/** @type {boolean} */ on) => document.body.classList.toggle('awaited', on);
  addEventListener('dragover', (event) => {
    if (!carries(event)) return;
    event.preventDefault();
    mark(true);
  });
  addEventListener('dragleave', ({ relatedTarget }) => relatedTarget || mark(false));
  addEventListener('drop', (event) => {
    mark(false);
    if (!carries(event)) return;
    // Else the browser would open it in place of the page.
    event.preventDefault();
    taken(event.dataTransfer?.files[0]);
  });
}
