#pragma once
#include <cstdint>

#include "scenes/generators/paper/mesh_builder.h"

namespace raymeter {

/// As in notation: king, queen, rook, bishop, knight, pawn.
enum class ChessPiece : char { king = 'K', queen = 'Q', rook = 'R', bishop = 'B', knight = 'N', pawn = 'P' };

/// Adds a piece of the Staunton kind, for squares of side 1, that stands on `foot`. A knight looks along
/// `ahead`, an upright piece's unit vector along the board.
void add_chess_piece(MeshBuilder& mesh, ChessPiece piece, const Vec3d& foot, const Vec3d& ahead);

}  // namespace raymeter
