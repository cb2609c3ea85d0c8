/** A name as names of packages are compared: an accented letter may be one character, or a letter and an accent. */
export const composed = (name) => name.normalize('NFC');

/** So are the morph targets of a mesh that three.js loaded. */
export function composeTargets(mesh) {
  const targets = Object.entries(mesh.morphTargetDictionary ?? {});
  if (targets.length) mesh.morphTargetDictionary = Object.fromEntries(targets.map(([name, index]) => [composed(name), index]));
}
