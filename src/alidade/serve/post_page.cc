// The page of `alidade serve`: what the map is, how to ask, and a form to try it with a picture.
#include "alidade/serve/response.h"

namespace alidade {
namespace {

constexpr std::string_view kPostHtml = R"html(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<meta name="color-scheme" content="light dark"><title>Alidade: where is the camera?</title>
<link rel="stylesheet" href="/localize.css"><script src="/localize.js" defer></script></head><body>
<h1>Where is the camera?</h1>
<p id="map">This program finds the pose of pictures in a map.</p>
<form id="form">
<p><label>Picture (JPEG or PNG) <input type="file" id="picture" accept="image/jpeg,image/png"></label></p>
<p><label>Lens <select id="lens">
<option value="">as the photo tells (EXIF)</option>
<option value="fov">horizontal field of view, degrees</option>
<option value="f">focal length, pixels</option>
<option value="camera">the camera of the map</option></select></label>
<input id="number" inputmode="decimal" size="8" hidden></p>
<p><button>Find</button></p>
</form>
<p id="told" role="status"></p>
<figure hidden><img id="shown" alt="The picture"></figure>
<table id="result" hidden></table>
<h2>From a program</h2>
<pre id="curl"></pre>
<p>The answer is JSON: position and quaternion (x, y, z, w) of the camera in the map, their covariance, how probable
the pose is, or why there is none.</p>
</body></html>
)html";

constexpr std::string_view kPostCss =
    R"css(body { font: 16px/1.5 system-ui, sans-serif; margin: 2rem auto;
  max-width: 46rem; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin-top: 2rem; }
pre { overflow-x: auto; padding: .75rem; background: #8882; border-radius: .4rem; }
table { border-collapse: collapse; } td { padding: .15rem 1rem .15rem 0; vertical-align: top; }
td:first-child { opacity: .7; } figure { margin: 1rem 0; } img { max-width: 100%; max-height: 20rem; }
button, input, select { font: inherit; } #told { font-weight: 600; }
)css";

constexpr std::string_view kPostScript = R"js('use strict';
const get = (id) => document.getElementById(id);
const token = new URLSearchParams(location.search).get('token');

function address(path, query) {
  if (token) query.set('token', token);
  const text = query.toString();
  return text ? path + '?' + text : path;
}

async function describe() {
  const map = await (await fetch(address('/map.json', new URLSearchParams()))).json();
  get('map').textContent = `${map.name}: ${map.keyframes} keyframes, ${map.landmarks} landmarks, made with ` +
    `${map.sensor} images of ${map.camera.width} x ${map.camera.height} pixels.`;
  const url = location.origin + address('/localize', new URLSearchParams({fov: '66'}));
  get('curl').textContent = `curl --data-binary @photo.jpg '${url}'`;
}

function row(name, value) {
  const line = get('result').insertRow();
  line.insertCell().textContent = name;
  line.insertCell().textContent = value;
}

function tell(answer) {
  get('result').replaceChildren();
  get('result').hidden = !answer.placed;
  if (!answer.placed) {
    get('told').textContent = `No pose: ${answer.why || answer.error}.`;
    return;
  }
  const unit = answer.unit === 'meters' ? ' m' : '';
  get('told').textContent = `Found, with probability ${answer.probability.toFixed(4)}.`;
  row('position', answer.position.map((x) => x.toFixed(3)).join(', ') + unit);
  row('quaternion', answer.quaternion.map((x) => x.toFixed(4)).join(', '));
  row('standard deviation', [0, 1, 2].map((i) => Math.sqrt(answer.covariance[i][i]).toFixed(4)).join(', ') + unit);
  row('landmarks', `${answer.inliers} found of ${answer.expected} expected`);
  row('time', `${answer.milliseconds.toFixed(0)} ms`);
}

async function find(event) {
  event.preventDefault();
  const file = get('picture').files[0];
  if (!file) { get('told').textContent = 'Choose a picture first.'; return; }
  const query = new URLSearchParams();
  const lens = get('lens').value;
  if (lens) query.set(lens, lens === 'camera' ? 'map' : get('number').value);
  get('told').textContent = 'Looking …';
  try {
    const response = await fetch(address('/localize', query), {method: 'POST', body: file});
    const text = await response.text();
    tell(response.headers.get('Content-Type') === 'application/json' ? JSON.parse(text) : {error: text.trim()});
  } catch (error) {
    get('told').textContent = `No answer: ${error.message}`;
  }
}

get('lens').addEventListener('change', () => { get('number').hidden = !['f', 'fov'].includes(get('lens').value); });
get('picture').addEventListener('change', () => {
  const file = get('picture').files[0];
  document.querySelector('figure').hidden = !file;
  if (get('shown').src) URL.revokeObjectURL(get('shown').src);
  if (file) get('shown').src = URL.createObjectURL(file);
});
get('form').addEventListener('submit', find);
describe().catch((error) => { get('map').textContent = `No answer: ${error.message}`; });
)js";

}  // namespace

const std::vector<PageFile>& PostFiles() {
  static const std::vector<PageFile> files = {
      {"index.html", kPostHtml}, {"localize.css", kPostCss}, {"localize.js", kPostScript}};
  return files;
}

}  // namespace alidade
