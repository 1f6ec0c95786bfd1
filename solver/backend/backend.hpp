// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "solver/backend/device_operator.hpp"
#include "solver/backend/device_vector.hpp"
#include "solver/backend/solid_device.hpp"
#include "solver/model/block_matrix.hpp"
#include "solver/model/model.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

enum class Precision { single, double_ };

/// How the stiffness product is computed.
enum class Product {
    automatic,    ///< the fastest on this device, measured at first use, see `ProductChoice`
    assembled,    ///< from a matrix of 3x3 blocks in compressed rows
    matrix_free,  ///< element by element, from stored gradients of the shape functions
    recomputed,   ///< element by element, from node positions
};

std::string name_of(Product product);  ///< "auto", "assembled", "matrix-free", "recomputed"

/// What `Product::automatic` chose for one number of columns, and why.
struct ProductChoice {
    Index columns = 1;
    Product product = Product::assembled;
    std::string reason;  ///< "assembled 0.09 ms, matrix-free 0.93 ms, recomputed 0.88 ms"
};

struct BackendOptions {
    Precision precision = Precision::single;  ///< of vectors and products on the device
    Product product = Product::automatic;
    std::string device;  ///< empty: best; else "platform.device" numbers or part of a device name
};

/// Who computes: written into every result.
struct BackendInfo {
    std::string backend;   ///< "reference", "opencl"
    std::string platform;  ///< empty for host back ends
    std::string device;
    std::string version;  ///< driver or library version
    Precision precision = Precision::double_;
    Product product = Product::assembled;  ///< as asked for
    std::vector<ProductChoice> choices;    ///< of an automatic product, so far
    int compute_units = 0;
    std::string type = "host";  ///< "CPU", "GPU" or "accelerator" where a driver says so
};

/// The operations that conjugate gradients, multigrid, the adjoint and condensation are written on.
/// One object holds one model. Vectors have `columns` >= 1 columns; those of the model have
/// 3 num_nodes rows (mm or mN). Functions may return before the device has done the work; those
/// that give numbers to the host wait for them. All functions throw Error(device_failed) when the
/// device reports an error, and Error(invalid_argument) on a size mismatch. Results are
/// deterministic: sums have a fixed order.
class Backend {
public:
    virtual ~Backend() = default;

    virtual BackendInfo describe() const = 0;

    /// Brings mesh, materials and prescribed flags to the device and computes element stiffness.
    /// Calls `check_model` first: no node number outside the mesh ever reaches a device.
    virtual void prepare(const Model& model) = 0;
    /// New Young's moduli [num materials], kPa, for the prepared model; geometry is kept.
    virtual void set_stiffness(std::span<const double> stiffness_kpa) = 0;

    virtual std::unique_ptr<DeviceVector> make_vector(Index rows, Index columns) = 0;
    /// Host arrays are [rows, columns] row-major (column index fastest), fp64.
    virtual void copy_in(std::span<const double> host, DeviceVector& v) = 0;
    virtual void copy_out(const DeviceVector& v, std::span<double> host) = 0;

    /// to[:, to_columns[i]] = from[:, from_columns[i]]; other columns of `to` stay. `from` may
    /// belong to a back end of another precision on the same device.
    virtual void copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                              DeviceVector& to, std::span<const Index> to_columns) = 0;
    virtual void fill(DeviceVector& v, double value) = 0;

    virtual std::unique_ptr<DeviceSums> make_sums(Index columns) = 0;
    virtual void set(DeviceSums& sums, std::span<const double> values) = 0;
    virtual void read(const DeviceSums& sums, std::span<double> values) = 0;
    /// xy_c = sum over rows of x_c y_c, accumulated in fp64 where the device has it.
    virtual void dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) = 0;

    /// A matrix with at most 6 x 6 entries per block on the device.
    ///   inverse_diagonal  [num_rows, b, b] inverted diagonal blocks of a square matrix, or empty:
    ///                     then `smooth` and `apply_inverse_diagonal` are refused
    virtual std::unique_ptr<DeviceOperator> make_operator(
        const BlockMatrix& matrix, std::span<const double> inverse_diagonal) = 0;
    /// New values in the pattern that `a` was made with.
    virtual void set_values(DeviceOperator& a, const BlockMatrix& matrix,
                            std::span<const double> inverse_diagonal) = 0;
    /// The stiffness K of the prepared model on free dofs, the identity at prescribed dofs (rows
    /// and columns). Follows `set_stiffness`; valid until the next `prepare`.
    virtual const DeviceOperator& stiffness() = 0;

    /// y = A x. `xy`, if given, receives x_c . y_c (A square).
    virtual void apply(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y,
                       DeviceSums* xy = nullptr) = 0;
    /// y += A x
    virtual void apply_add(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y) = 0;
    /// r = b - A x
    virtual void residual(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x,
                          DeviceVector& r) = 0;
    /// z = weight D^-1 r with the diagonal blocks D of `a`. `rz`, if given, receives r_c . z_c.
    virtual void apply_inverse_diagonal(const DeviceOperator& a, double weight,
                                        const DeviceVector& r, DeviceVector& z,
                                        DeviceSums* rz = nullptr) = 0;
    /// One step of a polynomial smoother for A x = b, from x to y:
    ///   y = alpha x + beta y + weight D^-1 (b - A x)
    /// With beta == 0 the old content of y is not read. `by`, if given, receives b_c . y_c.
    virtual void smooth(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x,
                        double alpha, double beta, double weight, DeviceVector& y,
                        DeviceSums* by = nullptr) = 0;

    /// Along the search directions p with q = A p, for every column c whose sum rr_c exceeds
    /// limit_c and whose pq_c is positive:
    ///   x += (rz / pq) p,  r -= (rz / pq) q
    /// Other columns stay. `rr_new`, another object than `rr`, receives r_c . r_c of all columns.
    virtual void advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                         const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                         DeviceVector& x, DeviceVector& r, DeviceSums& rr_new) = 0;
    /// p = z + (rz_new / rz) p, column by column; p = z where rz is not positive.
    virtual void turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
                      DeviceVector& p) = 0;

    /// y = K x without regard to prescribed dofs: nodal forces (mN) of the displacement x (mm).
    virtual void internal_force(const DeviceVector& x, DeviceVector& y) = 0;
    /// energy_c = 1/2 x_c . K x_c (mN mm), unconstrained.
    virtual void strain_energy(const DeviceVector& x, std::span<double> energy) = 0;
    /// gradient[material] = sum over columns of lambda_c . K_r x_c with K_r the unit-modulus
    /// stiffness of region r (unconstrained): dK/dE_r = K_r.
    virtual void parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                                    std::span<double> gradient) = 0;

    /// The element loops of large deformation for `model` (copied), beside the prepared one.
    /// Throws Error(invalid_argument) as `check_model` does, Error(unsupported) for what this back
    /// end has no loops for.
    virtual std::unique_ptr<SolidDevice> make_solid(const SolidModel& model) = 0;

    /// Returns when everything asked for has been done.
    virtual void wait() = 0;
};

}  // namespace palpate
