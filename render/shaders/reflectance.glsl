// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// After surface.glsl: what a surface returns toward the eye, a lux of a light that faces it.

// glTF 2.0, appendix B.3: Trowbridge–Reitz distribution, Smith masking, Schlick's Fresnel term.
// spread: tangent of the light's angular radius, which widens the lobe
vec3 metallic_roughness(Surface s, vec3 to_light, float cosine, float spread) {
  vec3 h = to_light + s.to_eye;
  h *= inversesqrt(max(dot(h, h), 1e-12));  // a light exactly behind has none
  float nv = max(dot(s.normal, s.to_eye), 1e-4);
  float nh = max(dot(s.normal, h), 0.0);
  float vh = max(dot(s.to_eye, h), 0.0);
  // Slopes of variance α²/2 an axis, and of a disc spread²/4, which reflection halves in angle.
  float alpha2 = min(s.alpha2 + spread * spread / 8.0, 1.0);
  float t = nh * nh * (alpha2 - 1.0) + 1.0;
  float distribution = alpha2 / (kPi * t * t);
  float visibility = 0.5 / (cosine * sqrt(s.alpha2 + (1.0 - s.alpha2) * nv * nv) +
                            nv * sqrt(s.alpha2 + (1.0 - s.alpha2) * cosine * cosine));
  vec3 fresnel = s.specular + (1.0 - s.specular) * pow(1.0 - min(vh, 1.0), 5.0);
  return (1.0 - fresnel) * s.diffuse / kPi + fresnel * distribution * visibility;
}

vec3 phong(Surface s, vec3 to_light, float spread) {
  float along = dot(s.mirrored, to_light);
  // A lobe of variance 1/n an axis over a disc of spread²/4 is one of their sum, of the same integral.
  float exponent = s.exponent / (1.0 + s.exponent * spread * spread / 4.0);
  float lobe = along > 0.0 || s.exponent == 0.0 ? pow(max(along, 1e-8), exponent) : 0.0;
  float scale = (s.exponent + 2.0) * (exponent + 1.0) / (s.exponent + 1.0);
  return s.diffuse / kPi + s.specular * (scale / (2.0 * kPi) * lobe);
}

vec3 reflectance(Surface s, vec3 to_light, float cosine, float spread) {
#if HAS_PHONG && HAS_METALLIC_ROUGHNESS
  return s.phong ? phong(s, to_light, spread) : metallic_roughness(s, to_light, cosine, spread);
#elif HAS_PHONG
  return phong(s, to_light, spread);
#else
  return metallic_roughness(s, to_light, cosine, spread);
#endif
}
