// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/delimited_text.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace palpate {
namespace {

std::string_view trimmed(std::string_view text) {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

/// One row after the other; a quote that is not closed ends with the text.
class RowReader {
public:
    RowReader(std::string_view text, const DelimitedFormat& format)
        : text_(text), separator_(format.separator), has_comments_(format.has_comments) {}

    bool next(RawRow& row) {
        skip_lines_without_cells();
        if (at_ == text_.size()) return false;
        row = {line_, {}, ""};
        while (read_cell(row)) {
        }
        return true;
    }

private:
    bool ends_line() const { return at_ == text_.size() || text_[at_] == '\n'; }

    void skip_lines_without_cells() {
        while (at_ < text_.size()) {
            const std::size_t end = std::min(text_.find('\n', at_), text_.size());
            const std::string_view line = text_.substr(at_, end - at_);
            const std::string_view content = has_comments_ ? trimmed(line) : line;
            const bool is_comment = has_comments_ && content.starts_with('#');
            if (!is_comment && content.find_first_not_of('\r') != std::string_view::npos) return;
            line_ += end < text_.size();
            at_ = std::min(end + 1, text_.size());
        }
    }

    std::string quoted(RawRow& row) {
        std::string cell;
        for (++at_; at_ < text_.size(); ++at_) {
            if (text_[at_] == '"' && text_.substr(at_, 2) != "\"\"") {
                ++at_;
                return cell;
            }
            if (text_[at_] == '"') ++at_;
            line_ += text_[at_] == '\n';
            cell += text_[at_];
        }
        row.complaint = "a quote is opened and never closed";
        return cell;
    }

    std::string plain() {
        const std::size_t begin = at_;
        while (!ends_line() && text_[at_] != separator_) ++at_;
        std::string cell(text_.substr(begin, at_ - begin));
        if (ends_line() && cell.ends_with('\r')) cell.pop_back();
        return has_comments_ ? std::string(trimmed(cell)) : cell;
    }

    /// Whether another cell of the same row follows.
    bool read_cell(RawRow& row) {
        const bool in_quotes = at_ < text_.size() && text_[at_] == '"';
        row.cells.push_back(in_quotes ? quoted(row) : plain());
        if (in_quotes && !plain().empty() && row.complaint.empty())
            row.complaint = "something follows a closing quote";
        const bool goes_on = at_ < text_.size() && text_[at_] == separator_;
        if (at_ < text_.size()) line_ += text_[at_++] == '\n';
        return goes_on;
    }

    std::string_view text_;
    char separator_;
    bool has_comments_;
    std::size_t at_ = 0, line_ = 1;
};

/// Whether it is UTF-8 without control characters; overlong forms and surrogates are not told.
bool is_clean_text(const std::string& cell) {
    std::size_t following = 0;
    for (const unsigned char byte : cell) {
        if (following > 0) {
            if ((byte & 0xC0) != 0x80) return false;
            --following;
        } else if (byte < 0x80) {
            if (byte < 0x20 || byte == 0x7F) return false;
        } else if ((byte & 0xE0) == 0xC0) {
            following = 1;
        } else if ((byte & 0xF0) == 0xE0) {
            following = 2;
        } else if ((byte & 0xF8) == 0xF0) {
            following = 3;
        } else {
            return false;
        }
    }
    return following == 0;
}

void take_header(RawRow& row, DelimitedText& table) {
    if (!row.complaint.empty()) table.faults.push_back({row.line, "", row.complaint});
    for (const std::string& name : row.cells)
        if (std::count(row.cells.begin(), row.cells.end(), name) > 1 &&
            std::none_of(table.faults.begin(), table.faults.end(),
                         [&](const TableFault& fault) { return fault.column == name; }))
            table.faults.push_back({row.line, name, "the header names this column twice"});
    table.header_line = row.line;
    table.columns = std::move(row.cells);
}

/// Whether it has no fault.
bool check_row(const RawRow& row, bool takes_any_text, DelimitedText& table) {
    const std::size_t before = table.faults.size();
    if (!row.complaint.empty()) {
        table.faults.push_back({row.line, "", row.complaint});
    } else if (row.cells.size() != table.columns.size()) {
        table.faults.push_back({row.line, "",
                                fmt::format("{} values for {} columns; give one for each",
                                            row.cells.size(), table.columns.size()),
                                row.cells.size()});
    } else if (!takes_any_text) {
        for (std::size_t k = 0; k < row.cells.size(); ++k)
            if (!is_clean_text(row.cells[k]))
                table.faults.push_back({row.line, table.columns[k],
                                        "the cell holds control characters or is not UTF-8"});
    }
    return table.faults.size() == before;
}

std::string_view without_mark(std::string_view text) {
    return text.substr(text.starts_with("\xEF\xBB\xBF") ? 3 : 0);
}

}  // namespace

std::optional<std::size_t> DelimitedText::find(std::string_view column) const {
    const auto found = std::find(columns.begin(), columns.end(), column);
    if (found == columns.end()) return std::nullopt;
    return static_cast<std::size_t>(found - columns.begin());
}

void for_each_row(std::string_view text, const DelimitedFormat& format,
                  const std::function<void(RawRow&)>& take) {
    RowReader reader(without_mark(text), format);
    for (RawRow row; reader.next(row);) take(row);
}

void read_delimited(std::string_view text, const DelimitedFormat& format, DelimitedText& table,
                    const std::function<void(RawRow&)>& take) {
    bool has_header = false;
    for_each_row(text, format, [&](RawRow& row) {
        if (!has_header) {
            take_header(row, table);
            has_header = true;
        } else if (check_row(row, format.takes_any_text, table)) {
            take(row);
        }
    });
    if (!has_header) table.faults.push_back({0, "", "the table is empty"});
}

DelimitedText parse_delimited(std::string_view text, const DelimitedFormat& format) {
    DelimitedText table;
    read_delimited(text, format, table, [&](RawRow& row) {
        table.rows.push_back(std::move(row.cells));
        table.lines.push_back(row.line);
    });
    return table;
}

std::string delimited_line(const std::vector<std::string>& cells, char separator) {
    std::string line;
    for (std::size_t k = 0; k < cells.size(); ++k) {
        if (k > 0) line += separator;
        const std::string& cell = cells[k];
        if (cell.find_first_of(std::string("\"\r\n") + separator) == std::string::npos) {
            line += cell;
            continue;
        }
        line += '"';
        for (const char c : cell) line += c == '"' ? "\"\"" : std::string(1, c);
        line += '"';
    }
    return line + '\n';
}

}  // namespace palpate
