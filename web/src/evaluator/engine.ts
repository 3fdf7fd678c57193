/** The library as WebAssembly: what `web/engine` exports, with text in and text out. */

interface Exports {
  memory: WebAssembly.Memory;
  input(length: number): number;
  put(nameLength: number): void;
  ask(): number;
  part(index: number, count: number): number;
  take(): void;
  output(): number;
}

export class Engine {
  private constructor(private readonly exports: Exports) {}

  /** Makes an engine without files. */
  static async of(module: WebAssembly.Module): Promise<Engine> {
    const instance = await WebAssembly.instantiate(module, {});
    return new Engine(instance.exports as unknown as Exports);
  }

  /** Adds a file, or replaces it. */
  put(name: string, text: string): void {
    this.exports.put(this.write(name, text));
  }

  /** Answers a request of JSON by JSON; `parts` are those of its map, if they were computed before. */
  ask(request: string, parts: Uint8Array[] = []): string {
    for (const part of parts) {
      this.input(part);
      this.exports.take();
    }
    this.write("", request);
    return new TextDecoder().decode(this.output(this.exports.ask()));
  }

  /** Computes a part of the deviations of the map in a request, from 0; empty if they cannot be divided. */
  part(request: string, index: number, count: number): Uint8Array<ArrayBuffer> {
    this.write("", request);
    return this.output(this.exports.part(index, count)).slice();
  }

  private output(length: number): Uint8Array<ArrayBuffer> {
    return new Uint8Array(this.exports.memory.buffer as ArrayBuffer, this.exports.output(), length);
  }

  private input(bytes: Uint8Array): void {
    const pointer = this.exports.input(bytes.length);
    // The memory may have grown: its buffer is taken after the call.
    new Uint8Array(this.exports.memory.buffer, pointer, bytes.length).set(bytes);
  }

  /** Writes two texts one behind the other, and returns the number of bytes of the first. */
  private write(first: string, second: string): number {
    const encoder = new TextEncoder();
    const [head, tail] = [encoder.encode(first), encoder.encode(second)];
    const both = new Uint8Array(head.length + tail.length);
    both.set(head, 0);
    both.set(tail, head.length);
    this.input(both);
    return head.length;
  }
}
