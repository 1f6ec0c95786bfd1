// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/published.hpp"

namespace palpate {

std::string published_source() {
    return "Published: Lee, Foskey, Niethammer, Krajcevski and Lin, joint recovery of elasticity "
           "and forces in CT of the male pelvis; 6,119 nodes, voxels of 1 × 1 × 3 mm. Their scenes "
           "are not these phantoms, so compare sizes of errors, not single numbers.";
}

std::vector<PublishedStiffness> published_recovery() {
    return {{50, 49, "scene 1"},      {100, 101.18, "scene 1"}, {150, 158.79, "scene 1"},
            {200, 141.57, "scene 1"}, {250, 136.65, "scene 1"}, {300, 204.45, "scene 1"},
            {350, 176, "scene 1"},    {50, 51.33, "scene 2"},   {100, 102.90, "scene 2"},
            {150, 167.5, "scene 2"},  {200, 225.0, "scene 2"},  {250, 222.91, "scene 2"},
            {300, 275.0, "scene 2"},  {350, 277.97, "scene 2"}};
}

std::vector<PublishedStiffness> published_neo_hookean() {
    return {{50, 50.18, "scene 1"},  {100, 105.64, "scene 1"}, {150, 159, "scene 1"},
            {200, 172, "scene 1"},   {50, 45, "scene 2"},      {100, 105, "scene 2"},
            {150, 141.5, "scene 2"}, {200, 197, "scene 2"}};
}

std::vector<PublishedStiffness> published_surroundings() {
    return {
        {25, 25, "scene 2"}, {50, 50, "scene 2"}, {75, 76.5, "scene 2"}, {100, 108.16, "scene 2"}};
}

std::vector<PublishedTumour> published_tumour() {
    return {{0.10, 51.24, 53.55}, {0.25, 54.98, 56.90}, {0.50, 62.15, 69.62}, {0.75, 63.44, 70}};
}

std::vector<PublishedPoisson> published_poisson() {
    return {{0.30, "up to 45 to 60 % (at 50 kPa)"},
            {0.40, "mostly below 13 %"},
            {0.45, "mostly below 13 %"},
            {0.49, "up to 20 %"}};
}

std::vector<PublishedLandmarks> published_landmarks() {
    return {{2.6, 2.7}, {1.6, 2.1}, {1.0, 1.8}, {1.3, 1.7}, {2.0, 2.1}};
}

std::vector<PublishedSuckedTissue> published_sucked_tissue() {
    return {{100, 0.517, 23.1, 0.44, 3.4},
            {1000, 0.728, 11.9, 0.44, 5.1},
            {10000, 0.693, 12.0, 0.41, 4.7}};
}

std::string published_sucked_tissue_source() {
    return "Published: Vuskovic and Kauer, aspiration of tissue; one measurement fitted four "
           "times, without intervals. Its surface at rest and its cycle are not told, so compare "
           "what the assumption changes, not the numbers.";
}

}  // namespace palpate
