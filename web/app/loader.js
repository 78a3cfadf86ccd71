// All that runs in the page is packed in it. packed(id): the bytes of a part as they are; unpack(id): inflated;
// reportScript: what draws here and in the reports that are saved.
globalThis.packed = (id) => {
  const text = atob(document.getElementById(id).textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
};
globalThis.unpack = (id) => new Response(new Blob([packed(id)]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
const address = (script) => URL.createObjectURL(new Blob([script], { type: 'text/javascript' }));
const text = async (id) => new TextDecoder().decode(await unpack(id));
try {
  globalThis.reportScript = await text('report');
  await import(address((await text('main')).replaceAll('"scree-report"', `"${address(reportScript)}"`)));
} catch (error) {
  document.getElementById('wait').textContent = `This page cannot start: ${error.message}. It needs a browser of 2023 or later.`;
  document.body.dataset.ready = 'failed';
}
