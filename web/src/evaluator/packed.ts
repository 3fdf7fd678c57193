/** Content that the page holds compressed, in base64. */

export function unpacked(base64: string, format: CompressionFormat): Response {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format)));
}
