#pragma once
#include <array>

#include "scenes/geometry/primitives.h"

namespace raymeter {

/// Where a shape stands and how it is turned: `axes` are orthonormal. A point's coordinates (u, v, w) in it
/// are along these three.
struct Placement {
  Vec3d centre;
  std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
};

/// Axes with the third along `direction` (any length but 0) and the first as near to `across` as that allows,
/// which must not be parallel to it.
std::array<Vec3d, 3> axes_along(const Vec3d& direction, const Vec3d& across);

/// The part of an infinite shape between two values of w.
struct Stretch {
  double from, to;
};

// General quadrics of the usual kinds, u and v being divided by the radii a and b.
//
// Each is cut from its infinite surface by a box with sides along the scene's axes, the one that just holds
// its stretch. Where the placement's third axis is one of the scene's, the box cuts straight across and the
// shape ends exactly at from and to. Where it is tilted, the box can't cut it so: the stretch is all there,
// with what more of the surface lies in its box. For a cone or a cylinder with straight ends on a tilted axis
// use Quadric.
//
// Coefficients are rounded to float, so that the shape is off by about 2^-24 of its size.

/// (u/a)^2 + (v/b)^2 + (w/c)^2 = 1, whole.
GeneralQuadric ellipsoid(const Placement& placement, const Vec3d& radii);
/// (u/a)^2 + (v/b)^2 = 1.
GeneralQuadric elliptic_cylinder(const Placement& placement, double a, double b, const Stretch& stretch);
/// (u/a)^2 + (v/b)^2 = (w/c)^2: its tip is at w = 0, on both sides of which there is a part.
GeneralQuadric elliptic_cone(const Placement& placement, const Vec3d& radii, const Stretch& stretch);
/// (u/a)^2 + (v/b)^2 = w/c: its tip is at w = 0, and there is none below for c > 0 (nor above for c < 0).
GeneralQuadric elliptic_paraboloid(const Placement& placement, const Vec3d& radii, const Stretch& stretch);
/// (u/a)^2 + (v/b)^2 = 1 + (w/c)^2: its waist is at w = 0.
GeneralQuadric hyperboloid_of_one_sheet(const Placement& placement, const Vec3d& radii,
                                        const Stretch& stretch);
/// (u/a)^2 + (v/b)^2 = (w/c)^2 - 1: its two tips are at w = c and -c, with nothing between.
GeneralQuadric hyperboloid_of_two_sheets(const Placement& placement, const Vec3d& radii,
                                         const Stretch& stretch);

}  // namespace raymeter
