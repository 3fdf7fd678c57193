/** One thing at a time: while it is done, only the last of the wishes is remembered. */
export class Newest {
  private wish: (() => Promise<void>) | null = null;
  private busy = false;

  /** `failed` hears of what goes wrong. */
  constructor(private readonly failed: (failure: unknown) => void) {}

  async do(work: () => Promise<void>): Promise<void> {
    this.wish = work;
    if (this.busy) return;
    this.busy = true;
    while (this.wish) {
      const next: () => Promise<void> = this.wish;
      this.wish = null;
      await next().catch(this.failed);
    }
    this.busy = false;
  }
}
