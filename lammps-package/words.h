// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_WORDS_H
#define SPOT_WORDS_H

#include <charconv>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "spot/base/errors.hpp"

/// The words of one command, taken one after the other.
class Words {
 public:
  explicit Words(const std::vector<std::string>& words) : words_(words) {}

  bool empty() const { return next_ == words_.size(); }
  std::size_t taken() const { return next_; }

  /// The words from one on, up to the next.
  std::string text_since(std::size_t first) const {
    std::string text;
    for (; first < next_; ++first) text += (text.empty() ? "" : " ") + words_[first];
    return text;
  }

  bool next_is(const char* word) const { return !empty() && words_[next_] == word; }

  bool next_begins_with(const std::string& start) const {
    return !empty() && words_[next_].compare(0, start.size(), start) == 0;
  }

  bool next_is_number() const {
    double ignored;
    return !empty() && read(words_[next_], ignored);
  }

  std::string keyword() {
    keyword_ = words_[next_++];
    return keyword_;
  }

  std::string value(const char* what) {
    if (empty()) throw spot::InvalidParameter(spot::message("keyword '", keyword_, "' ends before its value ", what));
    return words_[next_++];
  }

  double number(const char* what) {
    const std::string word = value(what);
    double result = 0.0;
    if (!read(word, result) || !std::isfinite(result))
      throw spot::InvalidParameter(
          spot::message("'", word, "' is not a finite number, but keyword '", keyword_, "' needs one for ", what));
    return result;
  }

  double positive(const char* what) {
    const double result = number(what);
    if (result <= 0.0)
      throw spot::InvalidParameter(spot::message("'", keyword_, "' is ", result, " but ", what, " must be positive"));
    return result;
  }

  double not_negative(const char* what) {
    const double result = number(what);
    if (result < 0.0)
      throw spot::InvalidParameter(
          spot::message("'", keyword_, "' is ", result, " but ", what, " must be zero or positive"));
    return result;
  }

  long long integer(const char* what, long long least) {
    const std::string word = value(what);
    long long result = 0;
    const auto [end, error] = std::from_chars(word.c_str(), word.c_str() + word.size(), result);
    if (error != std::errc() || end != word.c_str() + word.size() || result < least)
      throw spot::InvalidParameter(spot::message("'", word, "' after keyword '", keyword_, "' must be a whole number, ",
                                                 least, " or more: ", what));
    return result;
  }

 private:
  static bool read(const std::string& word, double& result) {
    const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';  // from_chars takes no plus sign
    const char* first = word.c_str() + (plus ? 1 : 0);
    const auto [end, error] = std::from_chars(first, word.c_str() + word.size(), result);
    return error == std::errc() && end == word.c_str() + word.size();
  }

  const std::vector<std::string>& words_;
  std::size_t next_ = 0;
  std::string keyword_;
};

/// A value that has to be one of some words.
template <typename Value>
Value one_of(Words& words, const char* keyword, const std::map<std::string, Value>& allowed) {
  std::string known;
  for (const auto& entry : allowed) known += (known.empty() ? "'" : " or '") + entry.first + "'";
  const std::string word = words.value(known.c_str());
  const auto found = allowed.find(word);
  if (found == allowed.end())
    throw spot::InvalidParameter(spot::message("'", keyword, ' ', word, "' is not known; allowed is ", known));
  return found->second;
}

/// As message(), with all digits that tell two numbers apart.
template <typename... Parts>
std::string precise(const Parts&... parts) {
  std::ostringstream out;
  out.precision(17);
  (out << ... << parts);
  return out.str();
}

#endif
