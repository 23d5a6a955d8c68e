#include "scenes/generators/paper/chess_pieces.h"

#include "scenes/base/portable_math.h"

namespace raymeter {
namespace {

constexpr std::uint32_t pawn_sides = 16;
constexpr std::uint32_t sides = 24;  // of the other pieces

constexpr OutlinePoint pawn_outline[] = {{0.330, 0.00, true},
                                         {0.340, 0.05},
                                         {0.310, 0.10, true},
                                         {0.280, 0.11, true},
                                         {0.290, 0.15},
                                         {0.250, 0.20},
                                         {0.180, 0.27},
                                         {0.135, 0.37},
                                         {0.110, 0.49},
                                         {0.105, 0.56, true},
                                         {0.185, 0.59},
                                         {0.180, 0.63},
                                         {0.110, 0.65, true},
                                         {0.155, 0.71},
                                         {0.172, 0.78},
                                         {0.155, 0.855},
                                         {0.110, 0.91},
                                         {0.050, 0.942},
                                         {0, 0.95}};

constexpr OutlinePoint rook_outline[] = {
    {0.380, 0.00, true}, {0.390, 0.06},       {0.350, 0.12, true}, {0.310, 0.13, true}, {0.320, 0.18},
    {0.270, 0.24},       {0.225, 0.34},       {0.200, 0.52},       {0.195, 0.70, true}, {0.265, 0.74},
    {0.270, 0.78, true}, {0.285, 0.98, true}, {0.200, 0.98, true}, {0.190, 0.86, true}, {0, 0.86}};

constexpr OutlinePoint bishop_outline[] = {
    {0.360, 0.00, true}, {0.370, 0.06}, {0.330, 0.12, true}, {0.290, 0.13, true}, {0.300, 0.18},
    {0.250, 0.25},       {0.170, 0.36}, {0.130, 0.52},       {0.115, 0.72},       {0.115, 0.80, true},
    {0.210, 0.83},       {0.200, 0.87}, {0.120, 0.89, true}, {0.175, 0.98},       {0.180, 1.06},
    {0.145, 1.17},       {0.075, 1.27}, {0.035, 1.30, true}, {0.055, 1.34},       {0, 1.39}};

constexpr OutlinePoint queen_outline[] = {
    {0.400, 0.00, true}, {0.410, 0.07},       {0.370, 0.14, true}, {0.320, 0.15, true}, {0.330, 0.21},
    {0.270, 0.29},       {0.190, 0.43},       {0.145, 0.63},       {0.125, 0.90},       {0.125, 1.00, true},
    {0.235, 1.03},       {0.225, 1.08},       {0.135, 1.10, true}, {0.165, 1.25},       {0.245, 1.46, true},
    {0.185, 1.42, true}, {0.130, 1.47, true}, {0.045, 1.53, true}, {0.055, 1.58},       {0, 1.63}};
constexpr std::size_t queen_crown = 14;  // ring of the outline

constexpr OutlinePoint king_outline[] = {
    {0.410, 0.00, true}, {0.420, 0.07}, {0.380, 0.14, true}, {0.330, 0.15, true}, {0.340, 0.22},
    {0.280, 0.30},       {0.200, 0.44}, {0.155, 0.66},       {0.135, 0.98},       {0.135, 1.08, true},
    {0.250, 1.11},       {0.240, 1.16}, {0.145, 1.18, true}, {0.175, 1.34},       {0.245, 1.54, true},
    {0.215, 1.58},       {0.110, 1.64}, {0.045, 1.66, true}, {0.045, 1.68, true}, {0, 1.68}};

constexpr OutlinePoint knight_foot[] = {{0.380, 0.00, true}, {0.390, 0.06}, {0.350, 0.12, true},
                                        {0.310, 0.13, true}, {0.320, 0.18}, {0.300, 0.24},
                                        {0.270, 0.28, true}, {0, 0.28}};

constexpr OutlinePoint ear[] = {{0.055, 0, true}, {0.045, 0.07}, {0, 0.17}};

/// An elliptic section through a knight's neck and head: its centre, the direction in which the next lies
/// (turns from upright, forward), and its half axes from mane to throat and from cheek to cheek.
struct Section {
  double ahead, height, turn, half_length, half_width;
};
constexpr Section knight_sections[] = {{0.00, 0.28, 0.00, 0.260, 0.230},   {-0.02, 0.42, -0.02, 0.270, 0.185},
                                       {-0.05, 0.60, -0.03, 0.270, 0.160}, {-0.08, 0.78, -0.01, 0.255, 0.150},
                                       {-0.07, 0.95, 0.05, 0.235, 0.140},  {-0.01, 1.08, 0.12, 0.220, 0.135},
                                       {0.09, 1.13, 0.21, 0.190, 0.130},   {0.20, 1.08, 0.29, 0.150, 0.112},
                                       {0.30, 0.99, 0.34, 0.118, 0.092},   {0.38, 0.90, 0.36, 0.105, 0.085},
                                       {0.42, 0.85, 0.36, 0.070, 0.060}};

/// Raises and lowers the points of a ring in turns: `high` points of `period` by `rise`.
void notch(Ring& ring, std::size_t period, std::size_t high, double rise) {
  for (std::size_t side = 0; side < ring.points.size(); ++side)
    if (side % period < high) ring.points[side].y += rise;
}

void add_knight(MeshBuilder& mesh, const Vec3d& foot, const Vec3d& ahead) {
  const Vec3d up{0, 1, 0}, across = cross(ahead, up);
  mesh.add_lathe(foot, knight_foot, sides);
  std::vector<Ring> rings;
  for (const Section& section : knight_sections) {
    const Vec3d centre = foot + section.ahead * ahead + section.height * up;
    const auto [lean, upright] = sine_cosine_of_turns(section.turn);
    const Vec3d throat = upright * ahead - lean * up;
    Ring ring;
    for (std::uint32_t side = 0; side < sides; ++side) {
      const auto [sine, cosine] = sine_cosine_of_turns(double(side) / sides);
      ring.points.push_back(centre + (section.half_length * cosine) * throat -
                            (section.half_width * sine) * across);
    }
    rings.push_back(std::move(ring));
  }
  rings.push_back({{foot + 0.44 * ahead + 0.825 * up}, false});
  mesh.add_loft(rings);
  for (const double side : {-1.0, 1.0})
    mesh.add_lathe(foot - 0.02 * ahead + 1.24 * up + (0.075 * side) * across, ear, 12);
}

void add_king(MeshBuilder& mesh, const Vec3d& foot) {
  mesh.add_lathe(foot, king_outline, sides);
  mesh.add_box(foot + Vec3d{-0.035, 1.66, -0.035}, foot + Vec3d{0.035, 1.92, 0.035});
  for (const double side : {-1.0, 1.0})
    mesh.add_box(foot + Vec3d{0.07 * side - 0.035, 1.765, -0.035},
                 foot + Vec3d{0.07 * side + 0.035, 1.835, 0.035});
}

}  // namespace

void add_chess_piece(MeshBuilder& mesh, ChessPiece piece, const Vec3d& foot, const Vec3d& ahead) {
  switch (piece) {
    case ChessPiece::king:
      return add_king(mesh, foot);
    case ChessPiece::queen: {
      auto rings = turned_rings(foot, queen_outline, sides);
      notch(rings[queen_crown], 3, 1, 0.07);
      return mesh.add_loft(rings);
    }
    case ChessPiece::rook: {
      auto rings = turned_rings(foot, rook_outline, sides);
      for (const std::size_t rim : {11, 12}) notch(rings[rim], 4, 2, 0.12);
      return mesh.add_loft(rings);
    }
    case ChessPiece::bishop:
      return mesh.add_lathe(foot, bishop_outline, sides);
    case ChessPiece::knight:
      return add_knight(mesh, foot, ahead);
    case ChessPiece::pawn:
      return mesh.add_lathe(foot, pawn_outline, pawn_sides);
  }
}

}  // namespace raymeter
