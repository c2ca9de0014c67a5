// How much of a search is drawn while the view moves, and at once after a click: as many of its lines as take less than a tenth of a second.
// Graphics cards draw all of them; where software draws, some are left out until the view is still.

/** What a frame should take while the view moves, milliseconds. */
const WANTED = 70;
/** The least share of the lines. */
const LEAST = 0.02;
/** The view is still when nothing has moved it for so long, milliseconds. */
const STILL = 200;

export class Pace {
  constructor() {
    /** The share of the lines that a frame has time for. */ this.possible = 1;
    /** @type {ReturnType<typeof setTimeout> | undefined} */ this.timer = undefined;
  }
  /** The share of the lines that is drawn now. */
  get share() { return this.timer === undefined ? 1 : this.possible; }

  /** The view has moved. @param {() => void} still is called when lines are missing and the view is still */
  moved(still) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.timer = undefined;
      if (this.possible < 1) still();
    }, STILL);
  }
  /** A frame with a share of the lines has taken so long. @param {number} share @param {number} milliseconds */
  took(share, milliseconds) { this.possible = Math.min(1, Math.max(LEAST, (share * WANTED) / milliseconds)); }
}
