// page.js - heat on a geometry of three.js: attributes straight into a material
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { ready } from "heatdiff";
import { GeometrySurface } from "heatdiff/three";

await ready;
const T = "60h2"; // diffusion time, in squared mean edges

// A geometry with seams: three repeats the vertices where texture coordinates begin anew.
const geometry = new THREE.TorusKnotGeometry(1, 0.36, 300, 48);
let seams = "";
const surface = new GeometrySurface(geometry, { say: (text) => (seams = text) });

// ---- the scene ----

const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.shadowMap.enabled = true;
document.body.prepend(renderer.domElement);
const scene = new THREE.Scene(),
  camera = new THREE.PerspectiveCamera(35, 1, 0.1, 50);
scene.background = new THREE.Color("#ececeb");
camera.position.set(0.9, 2.2, 7.2);
const controls = new OrbitControls(camera, renderer.domElement);
controls.target.set(0, -0.12, 0);
controls.update();
scene.add(new THREE.HemisphereLight("#ffffff", "#cfc8bf", 1.9));
const sun = new THREE.DirectionalLight("#ffffff", 1.7);
sun.position.set(-2.5, 5, 3);
sun.castShadow = true;
sun.shadow.mapSize.set(2048, 2048);
sun.shadow.radius = 6;
sun.shadow.normalBias = 0.03;
Object.assign(sun.shadow.camera, { left: -3, right: 3, top: 3, bottom: -3 });
const ground = new THREE.Mesh(new THREE.PlaneGeometry(40, 40), new THREE.ShadowMaterial({ opacity: 0.2 }));
ground.rotation.x = -Math.PI / 2;
ground.position.y = -1.88;
ground.receiveShadow = true;

// A standard material whose colour comes from the attribute "heat", by the tool's colours, with isolines.
const range = { value: new THREE.Vector2(0, 1) };
const material = new THREE.MeshStandardMaterial({ roughness: 0.55 });
material.onBeforeCompile = (shader) => {
  shader.uniforms.range = range;
  shader.vertexShader = `attribute float heat;\nvarying float warm;\n${shader.vertexShader}`.replace(
    "#include <begin_vertex>",
    "#include <begin_vertex>\nwarm = heat;",
  );
  shader.fragmentShader = `varying float warm;\nuniform vec2 range;\n${shader.fragmentShader}`.replace(
    "#include <color_fragment>",
    `float s = clamp((warm - range.x) / (range.y - range.x), 0.0, 1.0);
     vec3 c[6] = vec3[6](vec3(0.212, 0.271, 0.592), vec3(0.514, 0.278, 0.757), vec3(0.878, 0.271, 0.592),
                         vec3(0.996, 0.514, 0.341), vec3(0.996, 0.749, 0.384), vec3(0.973, 0.949, 0.686));
     int i = min(4, int(5.0 * s));
     diffuseColor.rgb = pow(mix(c[i], c[i + 1], 5.0 * s - float(i)), vec3(2.2));
     float u = 14.0 * s, w = fwidth(u), d = abs(fract(u - 0.5) - 0.5);
     diffuseColor.rgb *= 1.0 - 0.6 * (1.0 - smoothstep(0.5, 1.4, d / w)) * step(0.5, u);`,
  );
};
const knot = new THREE.Mesh(geometry, material);
knot.castShadow = knot.receiveShadow = true;
scene.add(sun, knot, ground);

// ---- what is shown ----

let source = 0;

function ask(what) {
  if (what === "geodesic") return surface.geodesic(source);
  if (what === "signature") return surface.signature(T);
  return surface[what](source, T);
}

function show() {
  const begin = performance.now(),
    { attribute, report } = ask(document.getElementById("what").value),
    took = performance.now() - begin;
  geometry.setAttribute("heat", attribute);
  const values = attribute.array.filter(Number.isFinite);
  range.value.set(
    values.reduce((a, b) => Math.min(a, b)),
    values.reduce((a, b) => Math.max(a, b)),
  );
  const error =
    report.bound === null
      ? `about ${report.error.toPrecision(2)}`
      : `at most ${report.bound.toExponential(0)} of the largest value`;
  document.getElementById("said").textContent =
    `${seams}\n${surface.info.n} vertices, ${took.toFixed(0)} ms, error ${error}`;
  draw();
}

function draw() {
  renderer.render(scene, camera);
  window.example.frames++;
}

function resize() {
  renderer.setPixelRatio(Math.min(2, devicePixelRatio));
  renderer.setSize(innerWidth, innerHeight);
  camera.aspect = innerWidth / innerHeight;
  camera.updateProjectionMatrix();
  draw();
}

// The corner nearest to where the ray meets the surface.
function pick(x, y) {
  const ray = new THREE.Raycaster();
  ray.setFromCamera(new THREE.Vector2((2 * x) / innerWidth - 1, 1 - (2 * y) / innerHeight), camera);
  const [hit] = ray.intersectObject(knot);
  if (!hit) return -1;
  const at = geometry.attributes.position,
    far = (v) => new THREE.Vector3().fromBufferAttribute(at, v).distanceTo(hit.point);
  return [hit.face.a, hit.face.b, hit.face.c].reduce((a, b) => (far(b) < far(a) ? b : a));
}

let pressed = [0, 0];
renderer.domElement.addEventListener("pointerdown", (e) => (pressed = [e.clientX, e.clientY]));
renderer.domElement.addEventListener("pointerup", (e) => {
  if (Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) > 4) return;
  const v = pick(e.clientX, e.clientY);
  if (v < 0) return;
  source = window.example.source = v;
  show();
});
controls.addEventListener("change", draw);
document.getElementById("what").onchange = show;
addEventListener("resize", resize);
window.example = { frames: 0, source, surface, geometry, pick }; // for the console, and for the tests
resize();
source = window.example.source = Math.max(0, pick(0.42 * innerWidth, 0.4 * innerHeight));
show();
