#pragma once
#include "scenes/geometry/primitives.h"
#include "scenes/geometry/ray.h"

namespace raymeter {

/// What a hit is. One function per kind of primitive defines it, for everything in Raymeter:
///
///   The real line origin + t * direction, taken exactly from the ray's floats, meets the primitive, taken
///   exactly from its floats, at real numbers t. Each is rounded to the nearest float (ties to even; below
///   FLT_MIN in magnitude to 0; beyond FLT_MAX it is no hit). The answer is the least of those floats with
///   tnear < t <= tfar, or `no_hit`. A ray that is not traceable (ray.h) misses, and a primitive with a
///   number that is not finite is missed. A denormal number, of ray or primitive, counts as zero.
///
/// Computed in double, with exact integer arithmetic wherever a sign or a rounding is not certain, so the
/// answer does not depend on the machine, the compiler, the caller's flags or its mode of denormals (FTZ/DAZ
/// on or off). The rounding mode must be to nearest.

/// A triangle is closed; a ray coplanar with it misses; a triangle without area is never hit.
/// Two triangles that share an edge leave no gap: the sign of an edge is a function of its two vertices.
float decide(const Ray& ray, const Triangle& triangle);
/// The same, half the work, for a traceable ray whose line certainly passes through the triangle's inside.
float decide_inside(const Ray& ray, const Triangle& triangle);

/// Sphere, open cylinder, open cone. Touching counts as a hit. A ray that lies in the surface misses.
float decide(const Ray& ray, const Quadric& quadric);

/// Any quadric inside a box. Touching counts as a hit, of the surface and of the box. A ray that lies in the
/// surface misses, and so does every ray where the polynomial is a constant.
float decide(const Ray& ray, const GeneralQuadric& quadric);

}  // namespace raymeter
