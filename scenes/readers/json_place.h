#pragma once
#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "scenes/base/error.h"

namespace raymeter {

/// A value in a JSON document that knows where it is: what is wrong with it is said with file and JSON
/// pointer (RFC 6901). It refers to the document, which must outlive it.
class JsonPlace {
 public:
  /// The document itself. `file` is for messages.
  JsonPlace(const std::string& file, const nlohmann::json& document) : file_(&file), value_(&document) {}

  /// A member of an object. Without it, or when this is no object: an error.
  JsonPlace at(std::string_view key) const {
    const auto member = find(key);
    if (!member) fail(fmt::format("it has no {}", key));
    return *member;
  }
  std::optional<JsonPlace> find(std::string_view key) const {
    if (!value_->is_object()) fail("it is no object");
    const auto member = value_->find(key);
    if (member == value_->end()) return std::nullopt;
    return JsonPlace(*file_, *member, fmt::format("{}/{}", pointer_, key));
  }
  /// An item of an array; `index` is below size().
  JsonPlace at(std::size_t index) const {
    return JsonPlace(*file_, (*value_)[index], fmt::format("{}/{}", pointer_, index));
  }
  /// Another value at the same place: what the file means where it leaves something out.
  JsonPlace with(const nlohmann::json& value) const { return JsonPlace(*file_, value, pointer_); }
  std::size_t size() const {
    if (!value_->is_array()) fail("it is no array");
    return value_->size();
  }

  std::uint64_t integer() const {
    if (!value_->is_number_unsigned()) fail("it is no whole number, 0 or more");
    return value_->get<std::uint64_t>();
  }
  std::uint64_t integer_or(std::string_view key, std::uint64_t otherwise) const {
    const auto member = find(key);
    return member ? member->integer() : otherwise;
  }
  double number() const {
    if (!value_->is_number()) fail("it is no number");
    return value_->get<double>();
  }
  double number_or(std::string_view key, double otherwise) const {
    const auto member = find(key);
    return member ? member->number() : otherwise;
  }
  const std::string& text() const {
    if (!value_->is_string()) fail("it is no string");
    return value_->get_ref<const std::string&>();
  }

  /// Throws an Error that names file and pointer.
  [[noreturn]] void fail(std::string_view what) const {
    throw Error(fmt::format("{}: {}: {}", *file_, pointer_.empty() ? "/" : pointer_, what));
  }

 private:
  JsonPlace(const std::string& file, const nlohmann::json& value, std::string pointer)
      : file_(&file), value_(&value), pointer_(std::move(pointer)) {}

  const std::string* file_;
  const nlohmann::json* value_;
  std::string pointer_;
};

}  // namespace raymeter
