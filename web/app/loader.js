// All that runs in the page is packed in it. packed(id): the bytes of a part as they are; unpack(id): inflated.
globalThis.packed = (id) => {
  const text = atob(document.getElementById(id).textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
};
globalThis.unpack = (id) => new Response(new Blob([packed(id)]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
try {
  await import(URL.createObjectURL(new Blob([await unpack('main')], { type: 'text/javascript' })));
} catch (error) {
  document.getElementById('wait').textContent = `This page cannot start: ${error.message}. It needs a browser of 2023 or later.`;
  document.body.dataset.ready = 'failed';
}
