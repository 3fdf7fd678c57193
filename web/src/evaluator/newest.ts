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
          (failure) => (this.failed(failure), false),
        )),
      );
    }
    this.busy = false;
  }

  private waits(does: boolean): void {
    this.shown.forEach((of) => of.classList.toggle("waits", does));
  }
}
