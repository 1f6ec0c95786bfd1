// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/closed_document.hpp"

#include <fmt/format.h>

#include <sstream>

#include <toml++/toml.h>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Walks a document and puts numbers where paths lead to.
class Closer {
public:
    explicit Closer(const DocumentClosing& closing) : closing_(closing) {}

    void close(toml::table& table, const std::string& path) const {
        for (auto&& [key, node] : table) {
            const std::string name(key.str());
            if (const auto number = closing_.numbers.find(path + name);
                number != closing_.numbers.end())
                table.insert_or_assign(name, number->second);
            else if (toml::table* inner = node.as_table())
                close(*inner, path + name + '.');
            else if (toml::array* list = node.as_array())
                close(*list, path + name);
            else if (name == "file" && node.is_string() && closing_.file_name)
                *node.as_string() = closing_.file_name(**node.as_string());
        }
    }

private:
    void close(toml::array& list, const std::string& path) const {
        for (std::size_t k = 0; k < list.size(); ++k) {
            const std::string place = fmt::format("{}[{}]", path, k + 1);
            if (const auto number = closing_.numbers.find(place); number != closing_.numbers.end())
                list.replace(list.cbegin() + std::ptrdiff_t(k), number->second);
            else if (toml::table* inner = list[k].as_table())
                close(*inner, place + '.');
        }
    }

    const DocumentClosing& closing_;
};

}  // namespace

std::string closed_document(const std::string& toml, const std::string& source_name,
                            const DocumentClosing& closing) {
    try {
        toml::table document = toml::parse(toml);
        for (const std::string& key : closing.dropped) document.erase(key);
        Closer(closing).close(document, "");
        std::ostringstream out;
        out << document << '\n';
        return out.str();
    } catch (const toml::parse_error& e) {
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{}: not valid TOML: {}", source_name, e.description()));
    }
}

}  // namespace palpate
