#include "render/shaders.h"

namespace dexremoe::shaders {

const char kMeshVertex[] = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 camera_from_mesh;
uniform mat3 normal_matrix;
uniform mat4 projection;
out vec3 p;  // m, camera axes
out vec3 n;
void main() {
  vec4 at = camera_from_mesh * vec4(position, 1.0);
  p = at.xyz;
  n = normal_matrix * normal;
  gl_Position = projection * at;
}
)";

const char kImageVertex[] = R"(#version 330 core
out vec2 uv;
void main() {
  uv = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(uv * 2.0 - 1.0, 1.0, 1.0);
}
)";

const char kDepthFragment[] = R"(#version 330 core
void main() {}
)";

const char kGeometryFragment[] = R"(#version 330 core
in vec3 p;
in vec3 n;
out vec4 color;
void main() {
  vec3 normal = normalize(n);
  if (dot(normal, p) > 0.0) normal = -normal;
  color = vec4(normal, -p.z);
}
)";

// Normal-oriented hemisphere sampling (Mittring, "Finding next gen: CryEngine 2", 2007, with the
// range check that became common): which share of points near the surface lie behind the depth
// image.
const char kOcclusionFragment[] = R"(#version 330 core
in vec2 uv;
uniform sampler2D geometry;
uniform vec2 tangent;    // half the field of view's width and height at depth 1
uniform float radius;    // m
out float occlusion;
const int kSamples = 20;
vec3 PointAt(vec2 at, float depth) { return vec3((at * 2.0 - 1.0) * tangent * depth, -depth); }
void main() {
  vec4 here = texture(geometry, uv);
  occlusion = 1.0;
  if (here.w <= 0.0) return;
  vec3 p = PointAt(uv, here.w);
  vec3 normal = here.xyz;
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  float turn = float(cell.x * 4 + ((cell.y * 7 + cell.x * 5) & 3)) * (6.2831853 / 16.0);
  vec3 side = normalize(abs(normal.y) < 0.9 ? cross(normal, vec3(0, 1, 0)) : cross(normal, vec3(1, 0, 0)));
  vec3 other = cross(normal, side);
  float blocked = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    float t = (float(i) + 0.5) / float(kSamples);
    float angle = float(i) * 2.3999632 + turn;
    float height = sqrt(1.0 - t * 0.96);
    float reach = radius * mix(0.08, 1.0, fract(float(i) * 0.618 + 0.3) * fract(float(i) * 0.618 + 0.3));
    vec3 direction = (side * cos(angle) + other * sin(angle)) * sqrt(max(0.0, 1.0 - height * height)) + normal * height;
    vec3 q = p + direction * reach;
    vec2 at = q.xy / (-q.z * tangent) * 0.5 + 0.5;
    float depth = texture(geometry, at).w;
    float gap = -q.z - depth;
    float near = smoothstep(0.0, 1.0, radius / max(abs(here.w - depth), 1e-6));
    if (depth > 0.0 && gap > radius * 0.02) blocked += near;
  }
  occlusion = 1.0 - blocked / float(kSamples);
}
)";

const char kBlurFragment[] = R"(#version 330 core
in vec2 uv;
uniform sampler2D geometry;
uniform sampler2D source;
uniform float radius;
out float occlusion;
void main() {
  ivec2 size = textureSize(source, 0);
  ivec2 here = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(geometry, here, 0).w;
  float sum = 0.0, weight = 0.0;
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) {
      ivec2 at = clamp(here + ivec2(x, y), ivec2(0), size - 1);
      float w = abs(texelFetch(geometry, at, 0).w - depth) < 0.25 * radius ? 1.0 : 0.0;
      sum += w * texelFetch(source, at, 0).r;
      weight += w;
    }
  occlusion = weight > 0.0 ? sum / weight : 1.0;
}
)";

const char kBackgroundFragment[] = R"(#version 330 core
in vec2 uv;
uniform vec3 top;
uniform vec3 bottom;
out vec4 color;
void main() {
  vec3 srgb = mix(bottom, top, smoothstep(0.0, 1.0, uv.y));
  color = vec4(pow(srgb, vec3(2.2)), 1.0);
}
)";

namespace {

// Percentage-closer soft shadows (Fernando, NVIDIA, 2005): the farther the blocker, the softer.
constexpr char kShadow[] = R"(#version 330 core
in vec3 p;
in vec3 n;
uniform sampler2D shadow_map;
uniform sampler2D geometry;
uniform sampler2D occlusion_map;
uniform mat4 light_from_camera;  // to [0, 1]^3
uniform float light_extent;      // m across the shadow map and along it
uniform float supersample;
uniform vec3 light;
uniform vec3 up;
uniform vec3 base;
uniform float gloss;
uniform float opacity;
uniform int mode;  // 0 opaque, 1 translucent, 2 floor
uniform vec3 floor_center;
uniform float floor_radius;
uniform float feature;  // m, size of small things
out vec4 color;

vec2 Spot(int i, int count, float turn) {
  float r = sqrt((float(i) + 0.5) / float(count));
  float angle = float(i) * 2.3999632 + turn;
  return r * vec2(cos(angle), sin(angle));
}

// Share of the key light that arrives.
float Lit(vec3 normal) {
  float slope = 1.0 - clamp(dot(normal, light), 0.0, 1.0);
  vec3 at = p + normal * feature * (0.03 + 0.08 * slope);
  vec3 s = (light_from_camera * vec4(at, 1.0)).xyz;
  s.z = min(s.z, 1.0);  // beyond the map nothing can be told from its empty texels
  float turn = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  float search = 0.5 * feature / light_extent;
  float blockers = 0.0, sum = 0.0;
  for (int i = 0; i < 10; ++i) {
    float depth = texture(shadow_map, s.xy + search * Spot(i, 10, turn)).r;
    if (depth < s.z) { blockers += 1.0; sum += depth; }
  }
  if (blockers < 0.5) return 1.0;
  float gap = (s.z - sum / blockers) * light_extent;
  float soft = clamp(0.14 * gap, 0.03 * feature, 0.8 * feature) / light_extent;
  float lit = 0.0;
  for (int i = 0; i < 16; ++i)
    lit += texture(shadow_map, s.xy + soft * Spot(i, 16, turn)).r < s.z ? 0.0 : 1.0;
  return lit / 16.0;
}

// The occlusion image is coarser than this one: take the texels that lie at this depth.
float Ambient() {
  vec2 at = gl_FragCoord.xy / supersample - 0.5;
  ivec2 corner = ivec2(floor(at));
  vec2 part = at - vec2(corner);
  ivec2 last = textureSize(occlusion_map, 0) - 1;
  float sum = 0.0, weight = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2(i & 1, i >> 1);
    ivec2 texel = clamp(corner + step, ivec2(0), last);
    vec2 near = mix(1.0 - part, part, vec2(step));
    float off = abs(texelFetch(geometry, texel, 0).w + p.z) / feature;
    float w = (near.x * near.y + 1e-3) / (1e-3 + off * off);
    sum += w * texelFetch(occlusion_map, texel, 0).r;
    weight += w;
  }
  return sum / weight;
}
)";

// Key light with soft shadow, hemisphere and fill without, a rim from behind; GGX highlights
// (Walter et al., "Microfacet Models for Refraction", 2007).
constexpr char kSurface[] = R"(
float Highlight(vec3 normal, vec3 view, vec3 from, float rough) {
  vec3 h = normalize(view + from);
  float nh = max(dot(normal, h), 0.0), nl = max(dot(normal, from), 0.0), nv = max(dot(normal, view), 1e-3);
  float a = rough * rough, d = nh * nh * (a * a - 1.0) + 1.0;
  float k = 0.5 * a;
  float visible = 0.25 / ((nl * (1.0 - k) + k) * (nv * (1.0 - k) + k));
  float fresnel = 0.04 + 0.96 * pow(1.0 - max(dot(h, view), 0.0), 5.0);
  return a * a / (3.1415927 * d * d) * visible * fresnel * nl;
}

vec3 Shoulder(vec3 x) {  // keeps what is below 0.8 and bends the rest towards 1
  vec3 over = max(x - 0.8, 0.0);
  return min(x, 0.8) + 0.2 * (1.0 - exp(-over / 0.2));
}

void main() {
  vec3 view = normalize(-p);
  vec3 normal = normalize(n);
  if (dot(normal, view) < 0.0) normal = -normal;
  float ambient = mode == 1 ? 1.0 : Ambient();
  float lit = mode == 1 ? 1.0 : Lit(normal);
  if (mode == 2) {
    float fade = 1.0 - smoothstep(0.25, 1.0, distance(p, floor_center) / floor_radius);
    float dark = 1.0 - (1.0 - 0.30 * (1.0 - lit)) * mix(1.0, ambient, 0.75);
    color = vec4(0.03, 0.035, 0.05, fade * dark);
    return;
  }
  vec3 fill = normalize(vec3(0.8, 0.1, 0.6));
  vec3 back = normalize(vec3(0.5, 0.6, -0.7));
  float rough = mix(0.75, 0.22, gloss);
  float above = dot(normal, up) * 0.5 + 0.5;
  vec3 sky = mix(vec3(0.34, 0.33, 0.33), vec3(0.56, 0.58, 0.61), above);
  vec3 light_sum = sky * mix(ambient * ambient, ambient, 0.5);
  light_sum += vec3(0.86, 0.83, 0.79) * max(dot(normal, light), 0.0) * lit;
  light_sum += vec3(0.20, 0.21, 0.23) * max(dot(normal, fill), 0.0) * ambient;
  float facing = max(dot(normal, view), 0.0);
  float rim = pow(1.0 - facing, 4.0) * (0.3 + 0.7 * max(dot(normal, back), 0.0));
  vec3 shine = vec3(1.2) * Highlight(normal, view, light, rough) * lit +
               vec3(0.35) * Highlight(normal, view, fill, rough) * ambient;
  if (mode == 1) {
    float edge = pow(1.0 - facing, 2.0);
    color = vec4(Shoulder(base * (light_sum * 0.55 + 0.45) + shine * 0.6), opacity * mix(0.8, 1.7, edge));
    color.a = min(color.a, 0.95);
    return;
  }
  color = vec4(Shoulder(base * light_sum + shine + 0.10 * rim * ambient), 1.0);
}
)";

}  // namespace

std::string SurfaceFragment() { return std::string(kShadow) + kSurface; }

}  // namespace dexremoe::shaders
