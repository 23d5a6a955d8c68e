#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raymeter {

/// How structures, generated scenes and ray kinds are named: `name:parameter=value:parameter=value`.
/// %2C %3A %3D %25 stand for , : = % inside a value.
struct Spec {
  std::string name;
  std::vector<std::pair<std::string, std::string>> parameters;
};

/// Parses `text`, in which a comma list sweeps a parameter and several lists form the product
/// (`grid:cells=4,8:mailbox=on,off` is four specs, the last list varying fastest).
/// Throws Error on bad syntax or a product of more than 10,000.
std::vector<Spec> parse_specs(std::string_view text);

/// The same for a text that must name exactly one.
Spec parse_spec(std::string_view text);

enum class ParameterType {
  integer,  ///< whole number within [minimum, maximum]
  number,   ///< real number within [minimum, maximum]
  choice,   ///< one of `choices`
  flag,     ///< on or off
  vector,   ///< one number, or three joined by x (`8x8x4`), each within [minimum, maximum]
  text,
};

/// One row of a parameter table. The table is all there is to know about a parameter: parsing, checking,
/// defaults, canonical forms and `raymeter list` come from it.
struct Parameter {
  std::string name;
  ParameterType type;
  std::string default_value;
  std::string meaning;
  double minimum = 0;
  double maximum = 0;
  std::vector<std::string> choices = {};
};

/// A spec's values, checked against a parameter table, with defaults filled in.
class Arguments {
 public:
  /// Throws Error naming the spec, the parameter and what would be right.
  Arguments(const Spec& spec, std::span<const Parameter> table);

  std::int64_t integer(std::string_view name) const;
  double number(std::string_view name) const;
  bool flag(std::string_view name) const;
  const std::string& text(std::string_view name) const;     ///< of a text or a choice
  std::vector<double> vector(std::string_view name) const;  ///< 1 or 3 values

  /// The one form that records hold: every parameter, in the table's order, numbers in shortest form.
  const std::string& canonical() const { return canonical_; }
  /// The canonical form less the parameters that are at their default: what tables show.
  const std::string& brief() const { return brief_; }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::vector<std::pair<std::string, std::string>> values_;
  std::string canonical_, brief_;
};

/// "integer 1..4096, default 8" and the like: what a user may write.
std::string describe(const Parameter& parameter);

}  // namespace raymeter
