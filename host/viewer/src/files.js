// Files of the package, from the page's own folder: by fetch, or, in a folder that `facezip view --output` wrote, from
// scripts that hold them as text, since browsers let no page fetch from file:.

const waiting = new Map();
let base = '';

/** Where the folder `package` lies, ending in a slash. */
export function setBase(folder) { base = folder; }

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

/** Bytes of a file of the package. */
export function readFile(name) {
  const url = `${base}package/${name.split('/').map(encodeURIComponent).join('/')}`;
  return globalThis.facezipScripts ? readScript(name, url) : readUrl(name, url);
}
