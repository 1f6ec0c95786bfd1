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
/// that give numbers to the host wait for them. Results are deterministic: sums have a fixed order.
///
/// All functions throw Error(device_failed) when the device reports an error, and
/// Error(invalid_argument) on arguments that do not fit, which they name with their sizes. That is
/// checked here, once; the `do_` function of the back end refuses only what it alone can know: what
/// another back end made.
class Backend {
public:
    virtual ~Backend() = default;

    virtual BackendInfo describe() const = 0;

    /// Brings mesh, materials and prescribed flags to the device and computes element stiffness.
    /// Calls `check_model` first: no node number outside the mesh ever reaches a device.
    void prepare(const Model& model);
    /// New Young's moduli [num materials], kPa > 0, for the prepared model; geometry is kept.
    void set_stiffness(std::span<const double> stiffness_kpa);

    std::unique_ptr<DeviceVector> make_vector(Index rows, Index columns);
    /// Host arrays are [rows, columns] row-major (column index fastest), fp64.
    void copy_in(std::span<const double> host, DeviceVector& v);
    void copy_out(const DeviceVector& v, std::span<double> host);

    /// to[:, to_columns[i]] = from[:, from_columns[i]]; other columns of `to` stay. `from` may
    /// belong to a back end of another precision on the same device.
    void copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                      DeviceVector& to, std::span<const Index> to_columns);
    virtual void fill(DeviceVector& v, double value) = 0;

    std::unique_ptr<DeviceSums> make_sums(Index columns);
    void set(DeviceSums& sums, std::span<const double> values);
    void read(const DeviceSums& sums, std::span<double> values);
    /// xy_c = sum over rows of x_c y_c, accumulated in fp64 where the device has it.
    void dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy);

    /// A matrix with at most `max_block` x `max_block` entries per block on the device.
    ///   inverse_diagonal  [num_rows, b, b] inverted diagonal blocks of a square matrix, or empty:
    ///                     then `smooth` and `apply_inverse_diagonal` are refused
    std::unique_ptr<DeviceOperator> make_operator(const BlockMatrix& matrix,
                                                  std::span<const double> inverse_diagonal);
    /// New values in the pattern that `a` was made with (of which sizes and number of blocks are
    /// checked), and new inverted diagonal blocks if it was made with them.
    void set_values(DeviceOperator& a, const BlockMatrix& matrix,
                    std::span<const double> inverse_diagonal);
    /// The stiffness K of the prepared model on free dofs, the identity at prescribed dofs (rows
    /// and columns). Follows `set_stiffness`; valid until the next `prepare`.
    const DeviceOperator& stiffness();

    /// y = A x, where y is another vector than x. `xy`, if given, receives x_c . y_c (A square).
    void apply(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y,
               DeviceSums* xy = nullptr);
    /// y += A x, where y is another vector than x.
    void apply_add(const DeviceOperator& a, const DeviceVector& x, DeviceVector& y);
    /// r = b - A x, where r is another vector than b and x.
    void residual(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x,
                  DeviceVector& r);
    /// z = weight D^-1 r with the diagonal blocks D of `a`; z may be r. `rz`, if given, receives
    /// r_c . z_c of the old r.
    void apply_inverse_diagonal(const DeviceOperator& a, double weight, const DeviceVector& r,
                                DeviceVector& z, DeviceSums* rz = nullptr);
    /// One step of a polynomial smoother for A x = b, from x to y, another vector than b and x:
    ///   y = alpha x + beta y + weight D^-1 (b - A x)
    /// With beta == 0 the old content of y is not read. `by`, if given, receives b_c . y_c.
    void smooth(const DeviceOperator& a, const DeviceVector& b, const DeviceVector& x, double alpha,
                double beta, double weight, DeviceVector& y, DeviceSums* by = nullptr);

    /// Along the search directions p with q = A p, for every column c whose sum rr_c exceeds
    /// limit_c and whose pq_c is positive:
    ///   x += (rz / pq) p,  r -= (rz / pq) q
    /// Other columns stay. `rr_new`, another object than the other sums, receives r_c . r_c of all
    /// columns.
    void advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                 const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                 DeviceVector& x, DeviceVector& r, DeviceSums& rr_new);
    /// p = z + (rz_new / rz) p, column by column; p = z where rz is not positive.
    void turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
              DeviceVector& p);

    /// y = K x without regard to prescribed dofs: nodal forces (mN) of the displacement x (mm),
    /// another vector than y.
    void internal_force(const DeviceVector& x, DeviceVector& y);
    /// energy_c = 1/2 x_c . K x_c (mN mm), unconstrained.
    void strain_energy(const DeviceVector& x, std::span<double> energy);
    /// gradient[material] = sum over columns of lambda_c . K_r x_c with K_r the unit-modulus
    /// stiffness of region r (unconstrained): dK/dE_r = K_r.
    void parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                            std::span<double> gradient);

    /// The element loops of large deformation for `model` (copied), beside the prepared one.
    /// Throws Error(invalid_argument) as `check_model` does, Error(unsupported) for what this back
    /// end has no loops for.
    std::unique_ptr<SolidDevice> make_solid(const SolidModel& model);

    /// Returns when everything asked for has been done.
    virtual void wait() = 0;

protected:
    // The functions above, with arguments that fit. Of operators, `do_make_operator` makes the
    // pattern and `do_set_values` brings the values.
    virtual void do_prepare(const Model& model) = 0;
    virtual void do_set_stiffness(std::span<const double> stiffness_kpa) = 0;
    virtual std::unique_ptr<DeviceVector> do_make_vector(Index rows, Index columns) = 0;
    virtual void do_copy_in(std::span<const double> host, DeviceVector& v) = 0;
    virtual void do_copy_out(const DeviceVector& v, std::span<double> host) = 0;
    virtual void do_copy_columns(const DeviceVector& from, std::span<const Index> from_columns,
                                 DeviceVector& to, std::span<const Index> to_columns) = 0;
    virtual std::unique_ptr<DeviceSums> do_make_sums(Index columns) = 0;
    virtual void do_set(DeviceSums& sums, std::span<const double> values) = 0;
    virtual void do_read(const DeviceSums& sums, std::span<double> values) = 0;
    virtual void do_dot(const DeviceVector& x, const DeviceVector& y, DeviceSums& xy) = 0;
    virtual std::unique_ptr<DeviceOperator> do_make_operator(const BlockMatrix& matrix,
                                                             bool has_inverse_diagonal) = 0;
    virtual void do_set_values(DeviceOperator& a, const BlockMatrix& matrix,
                               std::span<const double> inverse_diagonal) = 0;
    virtual const DeviceOperator& do_stiffness() = 0;
    virtual void do_multiply(const OperatorProduct& product) = 0;
    virtual void do_apply_inverse_diagonal(const DeviceOperator& a, double weight,
                                           const DeviceVector& r, DeviceVector& z,
                                           DeviceSums* rz) = 0;
    virtual void do_advance(const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                            const DeviceSums& limit, const DeviceVector& p, const DeviceVector& q,
                            DeviceVector& x, DeviceVector& r, DeviceSums& rr_new) = 0;
    virtual void do_turn(const DeviceSums& rz_new, const DeviceSums& rz, const DeviceVector& z,
                         DeviceVector& p) = 0;
    virtual void do_internal_force(const DeviceVector& x, DeviceVector& y) = 0;
    virtual void do_strain_energy(const DeviceVector& x, std::span<double> energy) = 0;
    virtual void do_parameter_gradient(const DeviceVector& lambda, const DeviceVector& x,
                                       std::span<double> gradient) = 0;
    virtual std::unique_ptr<SolidDevice> do_make_solid(SolidTables tables) = 0;

private:
    void multiply(const char* function, const OperatorProduct& product);
    void require_model(const char* function) const;
    void require_dofs(const char* function, const DeviceVector& v) const;

    bool has_model_ = false;
    Index num_dofs_ = 0;
    std::size_t num_materials_ = 0;
};

}  // namespace palpate
