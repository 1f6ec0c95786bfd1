// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
//
// Shape gradients and volumes of all elements, once per mesh. One work item: one element.
//   edges     [num_elements, EDGE_REALS] mm, differences taken on the host in fp64
//   geometry  [num_elements, ELEMENT_REALS], written by the element's own work item only
PALPATE_KERNEL void element_geometry(global const real* edges, global real* geometry,
                                     int num_elements) {
    const size_t element = get_global_id(1);
    if (element < (size_t)num_elements) store_element(edges, geometry, element);
}
