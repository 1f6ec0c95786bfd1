// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/tree_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json finite_or_null(const std::vector<double>& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(finite_or_null(value));
    return list;
}

Json value_json(const FigureValue& value) {
    const auto written = [](const auto& held) -> Json {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, std::monostate>) {
            return nullptr;
        } else if constexpr (std::is_same_v<Held, double> ||
                             std::is_same_v<Held, std::vector<double>>) {
            return finite_or_null(held);
        } else if constexpr (std::is_same_v<Held, std::vector<std::vector<double>>>) {
            Json rows = Json::array();
            for (const std::vector<double>& row : held) rows.push_back(finite_or_null(row));
            return rows;
        } else {
            return held;
        }
    };
    return std::visit(written, value);
}

/// Interval, verdict and reason of an estimate, where it has them, into an object.
void add_certainty(const Figure& figure, const std::string& interval_name, Json& json) {
    if (figure.interval_95)
        json[interval_name] = {finite_or_null((*figure.interval_95)[0]),
                               finite_or_null((*figure.interval_95)[1])};
    if (!figure.verdict) return;
    json["verdict"] = name_of(*figure.verdict);
    json["reason"] = figure.reason;
}

void add_figure(const Figure& figure, Json& json) {
    if (figure.name.empty()) return;  // for people only
    if (!figure.is_estimate()) {
        json[figure.name] = value_json(figure.value);
    } else if (!figure.interval_name.empty()) {
        json[figure.name] = value_json(figure.value);
        add_certainty(figure, figure.interval_name, json);
    } else {
        Json estimate{{"value", value_json(figure.value)}, {"unit", figure.unit}};
        add_certainty(figure, "interval", estimate);
        json[figure.name] = estimate;
    }
}

Json part_json(const ResultTree& part) {
    if (part.shape == ResultTree::Shape::list) {
        Json list = Json::array();
        for (const ResultTree* one : part.parts()) list.push_back(part_json(*one));
        return list;
    }
    Json json = Json::object();
    for (const ResultTree::Child& child : part.children) {
        if (const auto* figure = std::get_if<Figure>(&child))
            add_figure(*figure, json);
        else
            json[std::get<ResultTree>(child).name] = part_json(std::get<ResultTree>(child));
    }
    return json;
}

}  // namespace

std::string tree_json(const ResultTree& tree) {
    return part_json(tree).dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace palpate
