// Files of the package, from the page's own folder: by fetch, or, in a folder that `facezip view --output` wrote, from
// scripts that hold them as text, since browsers let no page fetch from file:.

const waiting = new Map();

// Called by the scripts: package/NAME.js holds facezipFile("NAME", "base64").
globalThis.facezipFile = (name, base64) => {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  waiting.get(name)(bytes);
};

function readScript(name, url) {
  return new Promise((resolve, reject) => {
    waiting.set(name, resolve);
    const script = document.createElement('script');
    script.src = `${url}.js`;
    script.onload = () => script.remove();
    script.onerror = () => reject(new Error(`${name} is missing beside the page`));
    document.head.append(script);
  });
}

async function readUrl(name, url) {
  const response = await fetch(url).catch(() => null);
  if (!response?.ok) throw new Error(`${name} could not be read (${response?.status ?? 'the server does not answer'})`);
  return new Uint8Array(await response.arrayBuffer());
}

/** What gives the bytes of a file of the package by its name; `base` holds the folder `package`, and ends in a slash. */
export function fileReader(base = '') {
  return (name) => {
    const url = `${base}package/${name.split('/').map(encodeURIComponent).join('/')}`;
    return globalThis.facezipScripts ? readScript(name, url) : readUrl(name, url);
  };
}
