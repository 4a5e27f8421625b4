// SPDX-License-Identifier: Apache-2.0
// Checks of single keys.
#include "json_object.h"

namespace chandelier::baker {

std::string shown(const Json& value) {
  return shortened(value.dump(-1, ' ', true), 60);
}

size_t section_size(const Json& json, const char* section) {
  const auto it = json.find(section);
  return it != json.end() && it->is_array() ? it->size() : 0;
}

void Object::bad(const char* key, const std::string& what, const Json& value) const {
  fail(where + ", " + key, what + " (" + shown(value) + ")");
}

const Json* Object::find(const char* key, Need need) const {
  const auto it = json.find(key);
  if (it != json.end()) return &*it;
  if (need == Need::required) fail(where, std::string("has no ") + key);
  return nullptr;
}

void Object::text(const char* key, Need need) const {
  const Json* value = find(key, need);
  if (value && !value->is_string()) bad(key, "is not a string", *value);
}

void Object::boolean(const char* key) const {
  const Json* value = find(key);
  if (value && !value->is_boolean()) bad(key, "is not true or false", *value);
}

void Object::integer(const char* key, uint64_t least, uint64_t most, Need need) const {
  const Json* value = find(key, need);
  if (!value) return;
  if (!value->is_number_unsigned()) bad(key, "is not a whole number", *value);
  const auto number = value->get<uint64_t>();
  if (number < least || number > most) bad(key, "is out of range", *value);
}

void Object::number(const char* key, double least, double most, Need need) const {
  const Json* value = find(key, need);
  if (value) check_number(key, *value, least, most);
}

void Object::numbers(const char* key, size_t count, double least, double most) const {
  const Json* value = find(key);
  if (!value) return;
  if (!value->is_array() || value->size() != count) {
    bad(key, "is not an array of " + std::to_string(count) + " numbers", *value);
  }
  for (const Json& each : *value) check_number(key, each, least, most);
}

void Object::check_number(const char* key, const Json& value, double least, double most) const {
  if (!value.is_number()) bad(key, "is not a number", value);
  const double number = value.get<double>();
  if (!(number >= least && number <= most)) bad(key, "is out of range", value);
}

void Object::index(const char* key, size_t count, Need need) const {
  const Json* value = find(key, need);
  if (value) check_index(key, *value, count);
}

void Object::indices(const char* key, size_t count, Need need) const {
  const Json* value = find(key, need);
  if (!value) return;
  if (!value->is_array()) bad(key, "is not an array", *value);
  for (const Json& each : *value) check_index(key, each, count);
}

void Object::check_index(const char* key, const Json& value, size_t count) const {
  if (!value.is_number_unsigned()) bad(key, "is not an index", value);
  if (value.get<uint64_t>() >= count) {
    bad(key, "points past the end, there are " + std::to_string(count), value);
  }
}

std::optional<Object> Object::object(const char* key, Need need) const {
  const Json* value = find(key, need);
  if (!value) return std::nullopt;
  if (!value->is_object()) bad(key, "is not an object", *value);
  return Object{*value, where + ", " + key};
}

std::optional<Object> Object::extension(const char* name) const {
  const auto all = object("extensions");
  return all ? all->object(name) : std::nullopt;
}

std::vector<Object> Object::objects(const char* key, Need need) const {
  const Json* value = find(key, need);
  std::vector<Object> out;
  if (!value) return out;
  if (!value->is_array()) bad(key, "is not an array", *value);
  const std::string singular = std::string(key).substr(0, std::string(key).size() - 1);
  for (size_t i = 0; i < value->size(); ++i) {
    out.push_back({(*value)[i], where + ", " + singular + " " + std::to_string(i)});
    if (!(*value)[i].is_object()) fail(out.back().where, "is not an object (" + shown((*value)[i]) + ")");
  }
  return out;
}

}  // namespace chandelier::baker
