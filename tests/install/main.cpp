#include <cstdio>

#include "accel/registry.h"
#include "scenes/open_scene.h"

int main() {
  const raymeter::Scene scene = raymeter::open_scene("soup:triangles=100");
  std::printf("%zu triangles\n", scene.triangles().size());
  return scene.triangles().size() == 100 ? 0 : 1;
}
