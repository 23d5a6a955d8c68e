#pragma once
// What a plug-in is: a shared library with structures of somebody else's, for `raymeter compare --plugin
// FILE` and load_plugin (harness/load_plugin.h). One line makes it, in one of its sources:
//
//   RAYMETER_PLUGIN(register_mine)  // with void register_mine(raymeter::Registry&)
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "accel/registry.h"
#include "scenes/base/version.h"

namespace raymeter {

/// What a plug-in and the Raymeter that loads it must have in common to understand each other, as a text:
/// version, interface, C++ library, sizes of the types that they exchange.
using PluginAbi = std::array<char, 256>;

/// To be raised when a type of the interface changes without changing its size: a virtual function, the
/// meaning or order of members.
inline constexpr unsigned plugin_interface = 1;

/// The tag of the headers and compiler that compile this call.
consteval PluginAbi plugin_abi() {
  PluginAbi tag{};
  std::size_t end = 0;
  const auto add = [&](std::string_view text) {
    for (const char c : text) tag.at(end++) = c;
  };
  const auto add_number = [&](std::size_t number) {
    std::array<char, 20> digits{};
    std::size_t first = digits.size();
    do {
      digits.at(--first) = static_cast<char>('0' + number % 10);
      number /= 10;
    } while (number > 0);
    add(" ");
    add({digits.data() + first, digits.size() - first});
  };
  add("Raymeter " RAYMETER_VERSION ", interface");
  add_number(plugin_interface);
#if defined(_LIBCPP_ABI_VERSION)
  add(", libc++");
  add_number(_LIBCPP_ABI_VERSION);
#elif defined(_GLIBCXX_USE_CXX11_ABI)
  add(", libstdc++");
  add_number(_GLIBCXX_USE_CXX11_ABI);
#endif
#if defined(_GLIBCXX_DEBUG)
  add(" debug");
#endif
  add(", sizes");
  for (const std::size_t size :
       {sizeof(void*), sizeof(std::string), sizeof(Ray), sizeof(Hit), sizeof(RayCounters), sizeof(BatchView),
        sizeof(Structure), sizeof(StructureStats), sizeof(Triangle), sizeof(Quadric), sizeof(Camera),
        sizeof(Scene), sizeof(Parameter), sizeof(Arguments), sizeof(BuildInput), sizeof(StructureKind),
        sizeof(Registry)})
    add_number(size);
  return tag;
}

}  // namespace raymeter

/// Exports `register_structures`, a void function of a raymeter::Registry&, and the tag that is checked
/// before it is called. What it throws is reported as the reason why the plug-in can't be used.
#define RAYMETER_PLUGIN(register_structures)                                                           \
  extern "C" {                                                                                         \
  extern const raymeter::PluginAbi raymeter_plugin_abi __attribute__((visibility("default")));         \
  constinit const raymeter::PluginAbi raymeter_plugin_abi = raymeter::plugin_abi();                    \
  __attribute__((visibility("default"))) void raymeter_plugin_register(raymeter::Registry& registry) { \
    register_structures(registry);                                                                     \
  }                                                                                                    \
  }                                                                                                    \
  static_assert(true, "a semicolon may follow")
