#pragma once
#include <filesystem>

#include "harness/ray_batch.h"
#include "scenes/scene.h"

namespace raymeter {

// Ray files keep a batch for another day, another machine or another program: docs/ray-files.md says what
// lies where. Rays are kept bit by bit, so that a batch from a file has the hash of the batch that was
// written.

/// Writes the batch, made for this scene, to a file beside `file` that then takes its place: nobody ever sees
/// half of one. Throws Error when it can't be written.
void write_ray_file(const std::filesystem::path& file, const RayBatch& batch, const Scene& scene);

/// The batch in a file that was made for a scene of this one's hash. Its rays may hold anything, also NaN and
/// infinities: such rays miss. Its name says the file's. Throws Error, one line, for everything that is not
/// exactly what write_ray_file writes: another version, a byte too few or too many, a bit that is not as it
/// was. Allocates no more than the file's size.
RayBatch read_ray_file(const std::filesystem::path& file, const Scene& scene);

}  // namespace raymeter
