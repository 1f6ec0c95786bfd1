// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/supervised_child.hpp"

namespace palpate {
namespace {

constexpr std::size_t longest_log = 16 * 1024;
constexpr std::size_t longest_line = 4 << 20;

}  // namespace

void SupervisedChild::read(const std::function<void(const std::string&)>& line) {
    process_.errors().drain(log_);
    if (log_.size() > longest_log) log_.erase(0, log_.size() - longest_log);
    std::string more;
    process_.output().drain(more);
    lines_ += more;
    std::size_t begin = 0;
    for (std::size_t end; (end = lines_.find('\n', begin)) != std::string::npos; begin = end + 1)
        line(lines_.substr(begin, end - begin));
    lines_.erase(0, begin);
    if (lines_.size() > longest_line) lines_.clear();
}

}  // namespace palpate
