// Draws the 3-D view with WebGL2: points into a picture with depths, then that picture shaded so
// that near things stand out from what is behind them.

const kPointShader = `#version 300 es
precision highp float;
layout(location = 0) in vec3 place;
layout(location = 1) in float tag;
uniform mat4 clipFromPage;
uniform mat4 pageFromSet;
uniform vec3 palette[5];
uniform float size, least, most, cutAbove;
uniform vec4 cutPlane;
uniform int environment, hidden;
out vec3 colour;
flat out int shape;
void main() {
  vec4 there = pageFromSet * vec4(place, 1.0);
  gl_Position = clipFromPage * there;
  gl_PointSize = clamp(size / gl_Position.w, least, most);
  shape = 0;
  if (environment == 1) {
    float t = clamp((tag - 98.0) / 60.0, 0.0, 1.0);
    colour = t < 0.5 ? mix(palette[0], palette[1], 2.0 * t) : mix(palette[1], palette[2], 2.0 * t - 1.0);
    if (tag > cutAbove || dot(cutPlane, there) > 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  } else {
    int k = int(tag);
    colour = palette[k];
    shape = environment == 0 ? k + 1 : environment == 3 ? 4 : 0;
    if (((hidden >> k) & 1) == 1) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  }
}`;

const kPointColour = `#version 300 es
precision highp float;
in vec3 colour;
flat in int shape;
out vec4 result;
void main() {
  vec2 p = gl_PointCoord * 2.0 - 1.0;
  if (shape == 1 && abs(p.x) + abs(p.y) > 1.2) discard;
  if (shape == 2 && abs(p.x) > (p.y + 1.0) / 2.0 + 0.15) discard;
  if (shape == 3 && dot(p, p) > 1.0) discard;
  if (shape == 4 && max(abs(p.x), abs(p.y)) < 0.72 && abs(abs(p.x) - abs(p.y)) > 0.12) discard;
  result = vec4(colour, 1.0);
}`;

const kShadeVertex = `#version 300 es
void main() {
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(p, 0.0, 1.0);
}`;

const kShadeColour = `#version 300 es
precision highp float;
uniform sampler2D colours, depths;
uniform float near, far, reach;
out vec4 result;
float metres(ivec2 at) {
  float d = texelFetch(depths, at, 0).r * 2.0 - 1.0;
  return log2(2.0 * near * far / (far + near - d * (far - near)));
}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), most = textureSize(depths, 0) - 1;
  vec4 colour = texelFetch(colours, at, 0);
  float own = metres(at), hidden = 0.0;
  int r = int(reach);
  ivec2 around[8] = ivec2[8](ivec2(r, 0), ivec2(-r, 0), ivec2(0, r), ivec2(0, -r), ivec2(r, r),
                             ivec2(-r, r), ivec2(r, -r), ivec2(-r, -r));
  for (int k = 0; k < 8; ++k) {
    hidden += clamp((own - metres(clamp(at + around[k], ivec2(0), most))) * 25.0, 0.0, 1.0);
  }
  result = vec4(colour.rgb * exp(-0.19 * hidden), 1.0);
}`;

function makeProgram(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    throw new Error(`WebGL: ${gl.getProgramInfoLog(program)}`);
  }
  const uniforms = {};
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
    const name = gl.getActiveUniform(program, i).name.replace("[0]", "");
    uniforms[name] = gl.getUniformLocation(program, name);
  }
  return { program, uniforms };
}

/** Column-major 4 x 4 matrices. */
function clipFromPage(camera, aspect, near, far) {
  const { right, up, toViewer, eye, halfAngle } = camera, f = 1 / Math.tan(halfAngle);
  const row = (axis, s) => [axis[0] * s, axis[1] * s, axis[2] * s, -dot(axis, eye) * s];
  const x = row(right, f / aspect), y = row(up, f), back = row(toViewer, 1);
  const a = -(far + near) / (far - near), b = -2 * far * near / (far - near);
  const z = back.map((v, k) => a * v + (k === 3 ? b : 0)), w = back.map((v) => -v);
  return new Float32Array([0, 1, 2, 3].flatMap((k) => [x[k], y[k], z[k], w[k]]));
}

function matrixOf(pose) {
  const { r, t } = pose;
  return new Float32Array([r[0], r[3], r[6], 0, r[1], r[4], r[7], 0, r[2], r[5], r[8], 0, ...t, 1]);
}

const kIdentity = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);

class WebglScene {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error("WebGL2 is not there");
    this.gl = gl;
    this.points = makeProgram(gl, kPointShader, kPointColour);
    this.shade = makeProgram(gl, kShadeVertex, kShadeColour);
    this.sets = { environment: this.upload(page.environment), points: this.upload(page.points),
                  model: this.upload({ ...page.model, tag: new Uint8Array(page.model.count) }),
                  path: this.upload(pathSet()) };
    if (page.unseen) this.sets.unseen = this.upload(page.unseen);
    this.empty = gl.createVertexArray();
    this.target = gl.createFramebuffer();
  }

  upload(set) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const buffer = (data, place, size, type) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, type, false, 0, 0);
    };
    buffer(set.xyz, 0, 3, gl.FLOAT);
    buffer(set.tag, 1, 1, gl.UNSIGNED_BYTE);
    return { array, count: set.count };
  }

  /** Pictures of colours and depths of that size. */
  resize(width, height) {
    if (this.width === width && this.height === height) return;
    const gl = this.gl;
    const texture = (format, inner, type, attachment) => {
      const made = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, made);
      gl.texImage2D(gl.TEXTURE_2D, 0, inner, width, height, 0, format, type, null);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, attachment, gl.TEXTURE_2D, made, 0);
      return made;
    };
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.deleteTexture(this.colours ?? null);
    gl.deleteTexture(this.depths ?? null);
    this.colours = texture(gl.RGBA, gl.RGBA8, gl.UNSIGNED_BYTE, gl.COLOR_ATTACHMENT0);
    this.depths = texture(gl.DEPTH_COMPONENT, gl.DEPTH_COMPONENT24, gl.UNSIGNED_INT,
                          gl.DEPTH_ATTACHMENT);
    [this.width, this.height] = [width, height];
  }

  drawSet(name, how) {
    const gl = this.gl, { uniforms } = this.points, set = this.sets[name];
    gl.uniformMatrix4fv(uniforms.pageFromSet, false, how.matrix ?? kIdentity);
    gl.uniform3fv(uniforms.palette, [...Array(5).keys()].flatMap((k) => how.palette[k] ?? how.palette[0]).map((v) => v / 255));
    gl.uniform1f(uniforms.size, how.size);
    gl.uniform1f(uniforms.least, how.least);
    gl.uniform1f(uniforms.most, how.most);
    gl.uniform1f(uniforms.cutAbove, how.cutAbove ?? 1000);
    gl.uniform4fv(uniforms.cutPlane, how.cutPlane ?? [0, 0, 0, -1]);
    gl.uniform1i(uniforms.environment, how.environment ?? 2);
    gl.uniform1i(uniforms.hidden, how.hidden ?? 0);
    gl.bindVertexArray(set.array);
    gl.drawArrays(how.mode ?? gl.POINTS, how.first ?? 0, how.count ?? set.count);
  }

  /** layers: [name, how] in order. */
  draw(width, height, camera, layers) {
    const gl = this.gl, near = Math.max(0.02, camera.distance / 200), far = camera.distance + 5000;
    this.resize(width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.viewport(0, 0, width, height);
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(0.953, 0.957, 0.965, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.points.program);
    gl.uniformMatrix4fv(this.points.uniforms.clipFromPage, false,
                        clipFromPage(camera, width / height, near, far));
    for (const [name, how] of layers) this.drawSet(name, how);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(this.shade.program);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.colours);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.depths);
    gl.uniform1i(this.shade.uniforms.colours, 0);
    gl.uniform1i(this.shade.uniforms.depths, 1);
    gl.uniform1f(this.shade.uniforms.near, near);
    gl.uniform1f(this.shade.uniforms.far, far);
    gl.uniform1f(this.shade.uniforms.reach, Math.max(1, Math.round(width / 1400)));
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}

/** The path as a point set: its places are those of the vehicle's middle. */
function pathSet() {
  const xyz = new Float32Array(page.path.flat());
  return { xyz, tag: new Uint8Array(page.path.length), count: page.path.length };
}
