// What the pages of viewers share: fetch the job, time a frame, send the picture.

/// Runs `draw` with the job; tells in_browser.py when it ended, and of what it died.
export async function jobOf(draw) {
  let fault = "";
  try {
    await draw(await (await fetch("/job")).json());
  } catch (error) {
    fault = error.stack || String(error);
  }
  await fetch("/done", { method: "POST", body: fault });
}

/// Draws two frames, and sends the second one as PNG with its time; reading a pixel waits for it.
export async function send(picture, canvas, drawFrame) {
  const gl = canvas.getContext("webgl2");
  let ms = 0;
  for (let frame = 0; frame < 2; ++frame) {
    const start = performance.now();
    drawFrame();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    ms = performance.now() - start;
  }
  const png = await new Promise((done) => canvas.toBlob(done, "image/png"));
  await fetch(`/picture?file=${encodeURIComponent(picture.file)}&ms=${ms}`, { method: "POST", body: png });
}
