//! A sparse matrix over the contacts, column by column: square blocks of D components, the normal one and one tangential one, or
//! two of them in space.

use crate::groups::{Connected, distinct};

/// A square matrix over the contacts, stored by its blocks.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocks<const D: usize = 2> {
    /// Index of the first block of each column of blocks, and the number of blocks.
    starts: Vec<usize>,
    /// Row of each block; ascending within a column.
    rows: Vec<u32>,
    /// The columns of each block: of the normal force first.
    values: Vec<[[f64; D]; D]>,
    /// Index of the diagonal block of each column.
    own: Vec<usize>,
    /// Whether it was given by its entries, and these are symmetric bit by bit.
    symmetric: bool,
}

impl<const D: usize> Blocks<D> {
    /// A matrix over this many contacts from its entries: row, column (D per contact) and value. Repeated entries are added.
    pub fn from_entries(
        contacts: usize,
        entries: impl Iterator<Item = (usize, usize, f64)> + Clone,
    ) -> Self {
        let places = entries.clone().map(|(i, j, _)| (j / D, i / D));
        let places = distinct(places.chain((0..contacts).map(|k| (k, k))));
        let mut blocks = Blocks::at(contacts, &places);
        for (i, j, value) in entries {
            if let Some(block) = blocks.find(i / D, j / D) {
                blocks.values[block][j % D][i % D] += value;
            }
        }
        blocks.symmetric = blocks.equals_its_transpose();
        blocks
    }

    /// A full matrix from its columns, which are consecutive.
    pub fn from_dense(contacts: usize, columns: &[f64]) -> Self {
        let count = D * contacts;
        let places = (0..contacts).flat_map(|j| (0..contacts).map(move |i| (j, i)));
        let mut blocks = Blocks::at(contacts, &places.collect::<Vec<_>>());
        for (block, values) in blocks.values.iter_mut().enumerate() {
            let (j, i) = (block / contacts, block % contacts);
            let first = D * j * count + D * i;
            *values =
                std::array::from_fn(|k| std::array::from_fn(|l| columns[first + k * count + l]));
        }
        blocks
    }

    /// Zeros at these (column, row) places, which are sorted and include the diagonal.
    fn at(contacts: usize, places: &[(usize, usize)]) -> Self {
        let (mut starts, mut own) = (vec![0; contacts + 1], vec![0; contacts]);
        for (block, &(j, i)) in places.iter().enumerate() {
            starts[j + 1] = block + 1;
            if i == j {
                own[j] = block;
            }
        }
        Blocks {
            starts,
            rows: places.iter().map(|&(_, i)| i as u32).collect(),
            values: vec![[[0.0; D]; D]; places.len()],
            own,
            symmetric: false,
        }
    }

    fn equals_its_transpose(&self) -> bool {
        (0..self.contacts())
            .flat_map(|j| self.column(j).map(move |b| (j, b)))
            .all(|(j, (i, block))| {
                let other = self.find(j, i).map(|block| self.values[block]);
                other
                    .is_some_and(|other| (0..D).all(|k| (0..D).all(|l| other[l][k] == block[k][l])))
            })
    }

    /// Whether [`Blocks::row`] applies.
    pub fn is_symmetric(&self) -> bool {
        self.symmetric
    }

    /// The product of a contact's rows and `x`, for a symmetric matrix: its rows are its columns.
    pub fn row(&self, contact: usize, x: &[f64]) -> [f64; D] {
        let mut y = [0.0; D];
        for (i, block) in self.column(contact) {
            let x = &x[D * i..D * i + D];
            for (y, column) in y.iter_mut().zip(block) {
                let mut products = column.iter().zip(x).map(|(w, x)| w * x);
                let first = products.next().unwrap_or(0.0);
                *y += products.fold(first, |sum, product| sum + product);
            }
        }
        y
    }

    /// Number of contacts.
    pub fn contacts(&self) -> usize {
        self.own.len()
    }

    /// Index of a block, if it is stored.
    fn find(&self, i: usize, j: usize) -> Option<usize> {
        let (start, end) = (self.starts[j], self.starts[j + 1]);
        let found = self.rows[start..end].binary_search(&(i as u32)).ok()?;
        Some(start + found)
    }

    /// The blocks of a column of blocks with their rows.
    pub fn column(&self, j: usize) -> impl Iterator<Item = (usize, &[[f64; D]; D])> {
        let range = self.starts[j]..self.starts[j + 1];
        self.rows[range.clone()]
            .iter()
            .map(|&i| i as usize)
            .zip(&self.values[range])
    }

    /// The diagonal block of a contact.
    pub fn own(&self, contact: usize) -> &[[f64; D]; D] {
        &self.values[self.own[contact]]
    }

    /// Adds the product of a column of blocks and `x`, the components of its contact, to `y`; first that of the normal one.
    pub fn add_column(&self, j: usize, x: [f64; D], y: &mut [f64]) {
        if x == [0.0; D] {
            return;
        }
        for (i, block) in self.column(j) {
            for (column, x) in block.iter().zip(x).filter(|(_, x)| *x != 0.0) {
                for (y, w) in y[D * i..D * i + D].iter_mut().zip(column) {
                    *y += w * x;
                }
            }
        }
    }

    /// Adds the product with `x` to `y`.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        for j in 0..self.contacts() {
            self.add_column(j, std::array::from_fn(|k| x[D * j + k]), y);
        }
    }

    /// The independent parts: groups of contacts between which there are no blocks, each in ascending order.
    pub fn parts(&self) -> Vec<Vec<usize>> {
        let mut groups = Connected::new(self.contacts());
        for j in 0..self.contacts() {
            self.column(j).for_each(|(i, _)| groups.join(i, j));
        }
        groups.parts()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_the_connected_contacts() {
        let entries = [(0, 4, 1.0), (4, 0, 1.0), (7, 2, 2.0), (2, 7, 2.0)];
        let blocks = Blocks::<2>::from_entries(5, entries.iter().copied());
        assert_eq!(blocks.parts(), [vec![0, 2], vec![1, 3], vec![4]]);
    }

    #[test]
    fn repeated_entries_are_added_and_multiplied() {
        let entries = [(0, 0, 1.0), (1, 0, 2.0), (0, 0, 0.5), (3, 1, -1.0)];
        let blocks = Blocks::<2>::from_entries(2, entries.iter().copied());
        assert_eq!(blocks.own(0), &[[1.5, 2.0], [0.0, 0.0]]);
        let mut y = vec![0.0; 4];
        blocks.multiply(&[2.0, 3.0, 0.0, 0.0], &mut y);
        assert_eq!(y, [3.0, 4.0, 0.0, -3.0]);
        assert!(!blocks.is_symmetric());
    }

    #[test]
    fn rows_of_a_symmetric_matrix_give_its_product() {
        let half = [
            (0, 0, 1.5),
            (1, 0, 2.0),
            (2, 1, -0.5),
            (3, 0, 4.0),
            (3, 3, 1.0),
        ];
        let other = half
            .iter()
            .filter(|(i, j, _)| i != j)
            .map(|&(i, j, w)| (j, i, w));
        let entries: Vec<_> = half.iter().copied().chain(other).collect();
        let blocks = Blocks::<2>::from_entries(2, entries.into_iter());
        assert!(blocks.is_symmetric());
        let (x, mut y) = ([1.0, 2.0, -1.0, 3.0], vec![0.0; 4]);
        blocks.multiply(&x, &mut y);
        assert_eq!([blocks.row(0, &x), blocks.row(1, &x)].concat(), y);
    }

    #[test]
    fn a_full_matrix_has_all_blocks() {
        let columns: Vec<f64> = (0..16).map(f64::from).collect();
        let blocks = Blocks::<2>::from_dense(2, &columns);
        assert_eq!(blocks.own(1), &[[10.0, 11.0], [14.0, 15.0]]);
        let mut y = vec![0.0; 4];
        blocks.multiply(&[0.0, 1.0, 0.0, 0.0], &mut y);
        assert_eq!(y, [4.0, 5.0, 6.0, 7.0]);
    }
}
