// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// How much of a lamp's source a surface sees, by the source's perspective map (lamp_views.h). After shadow_texels.glsl.
uniform vec2 depth_terms;   // a depth is the first less the second over metres along the face's axis
uniform float map_texel;    // 1 / side of a map, texels
uniform float tile_side;    // of the atlas's side
uniform int tile_columns;
uniform float caster_slack;  // metres: how far casters in the maps may be from what is seen

// from: from the source, plane: normal of the triangle itself, both along the maps' axes; biased: 1 where the surface stands
// in the maps, else 0; fit: of a single face, or of all of a cube; tile: the source's first
float lamp_visibility(vec3 from, vec3 plane, float biased, vec4 fit, int tile) {
#if FACES > 1
  vec3 size = abs(from);
  int face;
  if (size.z >= max(size.x, size.y)) {
    face = from.z > 0.0 ? 0 : 5;
    plane.z = from.z > 0.0 ? plane.z : -plane.z;
    from.z = size.z;
  } else if (size.x >= size.y) {
    face = from.x > 0.0 ? 1 : 2;
    plane = vec3(plane.yz, from.x > 0.0 ? plane.x : -plane.x);
    from = vec3(from.yz, size.x);
  } else {
    face = from.y > 0.0 ? 3 : 4;
    plane = vec3(plane.xz, from.y > 0.0 ? plane.y : -plane.y);
    from = vec3(from.xz, size.y);
  }
  tile += face;
#endif
  if (from.z <= 0.0 || fit.x == 0.0) return 1.0;
  // Along the normal: for curved surfaces that triangles stand for a tenth of a texel, and what casters are off.
  float texel_m = from.z * map_texel / min(fit.x, fit.y);
  // Where the surface's own plane passes the source by a few texels, some of the four that a look-up takes look under what
  // stands on the surface. A texel higher none does: a metre along the normal moves the place by up * fit / from.z.
  vec2 up = plane.xy - plane.z * from.xy / from.z;
  float texel_up = from.z * map_texel * dot(abs(up), 1.0 / fit.xy) / max(dot(up, up), 0.05);
  float lift = clamp(3.0 + 0.5 * dot(plane, from) / max(texel_up, 1e-9), 0.0, 1.0);
  from += plane * max(lift * texel_up, biased * (0.1 * texel_m + caster_slack));
  float inverse = 1.0 / max(from.z, 1e-6);
  // The plane's inverse distance along the axis is dot(plane, tangents) / toward: even over the map, as a map's depth is.
  float toward = min(dot(plane, from), -LEAST_COSINE * length(from));
  BeforeMap b;
  b.place = from.xy * inverse * fit.xy + fit.zw;
  // What stands in the maps does not shade itself; the bottom of what stands on a floor that does not seals it to the floor.
  b.depth = depth_terms.x - depth_terms.y * inverse + (biased > 0.0 ? -DEPTH_SLACK : DEPTH_SLACK);
  b.slope = plane.xy * (-depth_terms.y * biased / toward) / fit.xy;
  b.tile = vec3(vec2(float(tile % tile_columns), float(tile / tile_columns)) * tile_side, tile_side);
  b.texel = map_texel;
  return lit_at(b, b.place);
}
