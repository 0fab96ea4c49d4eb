// Coordinates as people write and read them: latitude first; on a plane X, then Y.

const LETTERS = { N: ['lat', 1], S: ['lat', -1], E: ['lon', 1], O: ['lon', 1], W: ['lon', -1] };
const REMEDY = 'Write latitude, then longitude: 27.9881, 86.925 or 27°59\'17"N 86°55\'31"E';

/** What is wrong with coordinates: value, rule, remedy in one line. */
export class CoordinateError extends Error {}

const refuse = (value, rule, remedy = REMEDY) => {
  throw new CoordinateError(`${value}: ${rule}. ${remedy}.`);
};

/** Reads a place: [x, y] of the body (longitude, latitude). Throws a CoordinateError. */
export function parse(text, body) {
  const plain = text.trim().replaceAll('−', '-').replace(/\s+/g, ' ');
  if (!plain) refuse('Nothing', 'a place is needed');
  return body.plane ? parsePlane(plain, body) : parseGlobe(plain);
}

function parsePlane(text, body) {
  const remedy = 'Write X, then Y, in the units of the map';
  const list = text.split(/[\s,;]+/).filter(Boolean);
  const numbers = list.map(Number);
  if (numbers.length !== 2 || !numbers.every(Number.isFinite)) refuse(`“${text}”`, 'two numbers are needed', remedy);
  const [x, y] = numbers;
  if (x < body.west || x > body.east || y < body.south || y > body.north) {
    refuse(`${x}, ${y}`, `the map reaches from ${body.west}, ${body.south} to ${body.east}, ${body.north}`, remedy);
  }
  return [x, y];
}

function parseGlobe(text) {
  const [first, second] = halves(text.toUpperCase(), text);
  const [a, b] = [angle(first), angle(second)];
  if (a.axis && a.axis === b.axis) refuse(`“${text}”`, 'one latitude and one longitude are needed');
  const swapped = a.axis === 'lon' || b.axis === 'lat';
  const [lat, lon] = swapped ? [b.degrees, a.degrees] : [a.degrees, b.degrees];
  if (Math.abs(lat) > 90) refuse(`A latitude of ${lat}`, 'latitudes are -90 to 90 degrees');
  if (lon < -180 || lon > 360) refuse(`A longitude of ${lon}`, 'longitudes are -180 to 360 degrees');
  return [lon > 180 ? lon - 360 : lon, lat];
}

/** The two angles of a text. */
function halves(upper, text) {
  const letters = [...upper.matchAll(/[NSEWO]/g)].map((match) => match.index);
  if (letters.length === 2) {
    const cut = /^[NSEWO]/.test(upper) ? letters[1] : letters[0] + 1;
    return [upper.slice(0, cut), upper.slice(cut)];
  }
  for (const mark of [';', ',']) {
    const parts = upper.split(mark);
    if (parts.length === 2) return parts;
  }
  const words = upper.split(' ');
  if (words.length % 2 || letters.length) refuse(`“${text}”`, 'this is no pair of coordinates');
  return [words.slice(0, words.length / 2).join(' '), words.slice(words.length / 2).join(' ')];
}

/** One angle: degrees, or degrees, minutes and seconds, with a sign or a letter. */
function angle(text) {
  const half = text.replace(/^[\s,;]+|[\s,;]+$/g, '');
  const letter = /[NSEWO]/.exec(half)?.[0];
  const bare = half.replace(/[NSEWO]/, '').trim();
  const read = /^([-+]?)(\d+(?:\.\d+)?)(?:[°D:\s]+(\d+(?:\.\d+)?))?(?:['’′M:\s]+(\d+(?:\.\d+)?))?[°D'’′"”″\s]*$/.exec(bare);
  if (!read) refuse(`“${half}”`, 'this is no angle');
  const [degrees, minutes, seconds] = read.slice(2).map((part) => Number(part ?? 0));
  if (minutes >= 60 || seconds >= 60) refuse(`“${half}”`, 'minutes and seconds are below 60');
  const [axis, letterSign] = LETTERS[letter] ?? [null, 1];
  const sign = letterSign * (read[1] === '-' ? -1 : 1);
  return { axis, degrees: sign * (degrees + minutes / 60 + seconds / 3600) };
}

/** A place for people: 27.98810° N 86.92500° E, or X and Y. */
export function written([x, y], body, digits = 4) {
  if (body.plane) return `${grouped(x, 1)}, ${grouped(y, 1)}`;
  const one = (value, [plus, minus]) => `${Math.abs(value).toFixed(digits)}° ${value < 0 ? minus : plus}`;
  return `${one(y, 'NS')} ${one(x, 'EW')}`;
}

/** A place that `parse` reads. */
export function typed([x, y], body) {
  const digits = body.plane ? 2 : 6;
  const [first, second] = body.plane ? [x, y] : [y, x];
  return `${Number(first.toFixed(digits))}, ${Number(second.toFixed(digits))}`;
}

/** A number with thin spaces between thousands. */
export function grouped(value, digits = 0) {
  const [whole, rest] = Math.abs(value).toFixed(digits).split('.');
  const sign = value < 0 && Number(value.toFixed(digits)) !== 0 ? '−' : '';
  return sign + whole.replace(/\B(?=(\d{3})+$)/g, '\u2009') + (rest ? `.${rest}` : '');
}

/** A length for people. */
export function metres(value_m, digits = 0) {
  const size = Math.abs(value_m);
  if (size >= 100_000) return `${grouped(value_m / 1000)} km`;
  if (size >= 10_000) return `${(value_m / 1000).toFixed(1)} km`;
  return `${grouped(value_m, size < 10 ? Math.max(digits, 1) : digits)} m`;
}
