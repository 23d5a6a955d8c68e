#include "scenes/base/spec.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

constexpr std::size_t max_product = 10000;

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const auto at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

std::string unescape(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto code = text.substr(i, 3);
    if (code == "%2C" || code == "%3A" || code == "%3D" || code == "%25") {
      plain += code == "%2C" ? ',' : code == "%3A" ? ':' : code == "%3D" ? '=' : '%';
      i += 2;
    } else {
      plain += text[i];
    }
  }
  return plain;
}

std::string escape(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case ',':
        escaped += "%2C";
        break;
      case ':':
        escaped += "%3A";
        break;
      case '=':
        escaped += "%3D";
        break;
      case '%':
        escaped += "%25";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

bool in_range(const Parameter& p, double value) {
  return value >= p.minimum && value <= p.maximum;
}

/// The canonical form of a value, or nothing when it is not one.
std::optional<std::string> canonical_value(const Parameter& p, const std::string& text) {
  switch (p.type) {
    case ParameterType::integer: {
      const auto value = parse_number(text);
      if (!value || *value != std::floor(*value) || std::abs(*value) > 0x1p53 || !in_range(p, *value))
        return {};
      return fmt::format("{}", static_cast<std::int64_t>(*value));
    }
    case ParameterType::number: {
      const auto value = parse_number(text);
      if (!value || !in_range(p, *value)) return {};
      return fmt::format("{}", *value + 0.0);  // -0 is 0
    }
    case ParameterType::vector: {
      const auto parts = split(text, 'x');
      if (parts.size() != 1 && parts.size() != 3) return {};
      std::vector<std::string> forms;
      for (const auto part : parts) {
        const auto value = parse_number(part);
        if (!value || !in_range(p, *value)) return {};
        forms.push_back(fmt::format("{}", *value + 0.0));
      }
      return fmt::format("{}", fmt::join(forms, "x"));
    }
    case ParameterType::flag:
      if (text == "on" || text == "off") return text;
      return {};
    case ParameterType::choice:
      for (const auto& choice : p.choices)
        if (choice == text) return text;
      return {};
    case ParameterType::text:
      return text;
  }
  return {};
}

std::string what_is_allowed(const Parameter& p) {
  switch (p.type) {
    case ParameterType::integer:
      return fmt::format("a whole number {}..{}", p.minimum, p.maximum);
    case ParameterType::number:
      return fmt::format("a number {}..{}", p.minimum, p.maximum);
    case ParameterType::vector:
      return fmt::format("one number, or three joined by x, each {}..{}", p.minimum, p.maximum);
    case ParameterType::flag:
      return "on or off";
    case ParameterType::choice:
      return fmt::format("one of {}", fmt::join(p.choices, ", "));
    case ParameterType::text:
      return "text";
  }
  return {};
}

}  // namespace

std::vector<Spec> parse_specs(std::string_view text) {
  const auto parts = split(text, ':');
  if (parts[0].empty()) throw Error(fmt::format("'{}': a spec begins with a name", text));
  std::vector<Spec> specs{{std::string(parts[0]), {}}};
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const auto equals = parts[i].find('=');
    if (equals == std::string_view::npos || equals == 0)
      throw Error(fmt::format("'{}': expected parameter=value, found '{}'", text, parts[i]));
    const std::string name(parts[i].substr(0, equals));
    for (const auto& [earlier, value] : specs[0].parameters)
      if (earlier == name) throw Error(fmt::format("'{}': parameter '{}' is given twice", text, name));
    const auto values = split(parts[i].substr(equals + 1), ',');
    if (specs.size() * values.size() > max_product)
      throw Error(fmt::format("'{}': more than {} combinations", text, max_product));
    std::vector<Spec> product;
    for (const auto& spec : specs)
      for (const auto value : values) {
        product.push_back(spec);
        product.back().parameters.emplace_back(name, unescape(value));
      }
    specs = std::move(product);
  }
  return specs;
}

Spec parse_spec(std::string_view text) {
  auto specs = parse_specs(text);
  if (specs.size() != 1) throw Error(fmt::format("'{}': one value each is wanted here, not a list", text));
  return std::move(specs[0]);
}

Arguments::Arguments(const Spec& spec, std::span<const Parameter> table) : name_(spec.name) {
  for (const auto& [name, value] : spec.parameters) {
    bool known = false;
    for (const auto& p : table) known |= p.name == name;
    if (!known) {
      std::vector<std::string_view> names;
      for (const auto& p : table) names.push_back(p.name);
      throw Error(table.empty() ? fmt::format("{}: takes no parameters, found '{}'", spec.name, name)
                                : fmt::format("{}: no parameter '{}'; there are: {}", spec.name, name,
                                              fmt::join(names, ", ")));
    }
  }
  canonical_ = brief_ = name_;
  for (const auto& p : table) {
    const std::string* given = &p.default_value;
    for (const auto& [name, value] : spec.parameters)
      if (name == p.name) given = &value;
    auto value = canonical_value(p, *given);
    // A default may stand outside the range: it then means "not set".
    if (!value && *given == p.default_value) value = p.default_value;
    if (!value)
      throw Error(fmt::format("{}: {}='{}' should be {}", spec.name, p.name, *given, what_is_allowed(p)));
    const std::string text = fmt::format(":{}={}", p.name, escape(*value));
    canonical_ += text;
    if (*value != p.default_value) brief_ += text;
    values_.emplace_back(p.name, std::move(*value));
  }
}

const std::string& Arguments::text(std::string_view name) const {
  for (const auto& [known, value] : values_)
    if (known == name) return value;
  throw std::logic_error(fmt::format("{} has no parameter '{}' in its table", name_, name));
}

std::int64_t Arguments::integer(std::string_view name) const {
  return static_cast<std::int64_t>(number(name));
}

double Arguments::number(std::string_view name) const {
  const auto value = parse_number(text(name));
  if (!value) throw std::logic_error(fmt::format("{}: {} is no number", name_, name));
  return *value;
}

bool Arguments::flag(std::string_view name) const {
  return text(name) == "on";
}

std::vector<double> Arguments::vector(std::string_view name) const {
  std::vector<double> values;
  for (const auto part : split(text(name), 'x')) {
    const auto value = parse_number(part);
    if (!value) throw std::logic_error(fmt::format("{}: {} is no vector", name_, name));
    values.push_back(*value);
  }
  return values;
}

std::string describe(const Parameter& p) {
  return fmt::format("{}, default {}", what_is_allowed(p), p.default_value);
}

}  // namespace raymeter
