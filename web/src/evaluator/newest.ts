/** A question that a change of the text has ended; `rest` comes when the figures stand again. */
export class Abandoned extends Error {
  constructor(readonly rest: Promise<void>) {
    super("the text has changed");
  }
}

/** One thing at a time: while it is done, only the last of the wishes is remembered. */
export class Newest {
  private wish: (() => Promise<void>) | null = null;
  private busy = false;

  private readonly shown: HTMLElement[];

  /** `failed` hears of what goes wrong. What is `shown` is of before until it is done. */
  constructor(
    private readonly failed: (failure: unknown) => void,
    ...shown: HTMLElement[]
  ) {
    this.shown = shown;
  }

  async do(work: () => Promise<void>): Promise<void> {
    this.wish = work;
    if (this.busy) return;
    this.busy = true;
    this.waits(true);
    while (this.wish) {
      const next: () => Promise<void> = this.wish;
      this.wish = null;
      this.waits(
        !(await next().then(
          () => true,
          (failure: unknown) => this.ended(failure, next),
        )),
      );
    }
    this.busy = false;
  }

  /** What a change has ended is done again at rest, unless something newer is wished by then. */
  private async ended(failure: unknown, work: () => Promise<void>): Promise<boolean> {
    if (!(failure instanceof Abandoned)) this.failed(failure);
    else {
      await failure.rest;
      this.wish ??= work;
    }
    return false;
  }

  private waits(does: boolean): void {
    this.shown.forEach((of) => of.classList.toggle("waits", does));
  }
}
