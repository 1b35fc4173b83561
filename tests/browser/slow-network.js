// A network that lets a map through line by line.

/** Lets only so many lines of a map through, as a slow network would. Runs in the page. */
export function gate() {
  globalThis.linesLet = Infinity;
  globalThis.aborted = 0;
  const real = globalThis.fetch;
  globalThis.fetch = async (input, init) => {
    if (!String(input).includes('format=ndjson')) return real(input, init);
    init?.signal?.addEventListener('abort', () => {
      globalThis.aborted += 1;
    });
    const response = await real(input, init);
    let passed = 0;
    let rest = '';
    const slow = new TransformStream({
      async transform(chunk, out) {
        const lines = (rest + new TextDecoder().decode(chunk)).split('\n');
        rest = lines.pop();
        for (const line of lines) {
          while (passed >= globalThis.linesLet && !init.signal.aborted)
            await new Promise((done) => setTimeout(done, 5));
          if (init.signal.aborted) return;
          passed += 1;
          out.enqueue(new TextEncoder().encode(`${line}\n`));
        }
      },
    });
    return new Response(response.ok ? response.body.pipeThrough(slow) : response.body, {
      status: response.status,
      headers: response.headers,
    });
  };
}
