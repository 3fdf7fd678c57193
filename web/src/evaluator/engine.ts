/** The library as WebAssembly: what `web/engine` exports, with text in and text out. */

interface Exports {
  memory: WebAssembly.Memory;
  input(length: number): number;
  put(nameLength: number): void;
  ask(): number;
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

  /** Answers a request of JSON by JSON. */
  ask(request: string): string {
    this.write("", request);
    const length = this.exports.ask();
    const bytes = new Uint8Array(this.exports.memory.buffer, this.exports.output(), length);
    return new TextDecoder().decode(bytes);
  }

  /** Writes two texts one behind the other, and returns the number of bytes of the first. */
  private write(first: string, second: string): number {
    const encoder = new TextEncoder();
    const [head, tail] = [encoder.encode(first), encoder.encode(second)];
    const pointer = this.exports.input(head.length + tail.length);
    // The memory may have grown: its buffer is taken after the call.
    const buffer = new Uint8Array(this.exports.memory.buffer, pointer, head.length + tail.length);
    buffer.set(head, 0);
    buffer.set(tail, head.length);
    return head.length;
  }
}
