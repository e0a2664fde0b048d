//! A master surface as a curve in the plane, looked at by brute force: densely sampled, then refined by bisection.
//!
//! Outward is to the right of the walk along the chain; a tangent points along the walk.

use std::sync::OnceLock;

/// A point or a vector in the plane.
pub type Point = [f64; 2];

/// Samples of an element between which a closest point is looked for.
const SAMPLES: usize = 64;
/// Most nodes of an element.
const MOST: usize = 9;
/// Panels of three Gauss points each, for the length of a part of an element.
const PANELS: usize = 8;

/// A chain of elements, each a Lagrange curve through its nodes at equal steps of ξ from −1 to 1. A smooth chain is one of
/// cubics, each through four points of the smooth curve.
#[derive(Debug, Clone)]
pub struct Chain {
    elements: Vec<Vec<Point>>,
    /// The last element ends where the first begins.
    closed: bool,
    /// Straight on past both ends; one element of two nodes.
    endless: bool,
    /// From these ξ of the first and of the last element on, only a node that is pressed is over the chain.
    held: [f64; 2],
}

/// A material point of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    pub element: usize,
    pub xi: f64,
}

/// A point of the chain that is closer to some point than its neighbours are, or a border, or an end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    pub foot: Point,
    pub distance: f64,
    pub at: At,
}

/// Where on the chain a site lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum At {
    Inside(Place),
    /// Where one element ends and the next begins.
    Border(Place, Place),
    End(Place),
}

/// What a chain is to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Seen {
    /// The closest point of the chain, and the distance: negative inside.
    Over(Site, f64),
    /// The closest point is an end, and the point lies beyond it by this much.
    Beyond(Site, f64),
}

impl Chain {
    /// A chain over nodes, of whose positions these are the present ones.
    pub fn new(elements: &[Vec<usize>], positions: &[Point], endless: bool) -> Self {
        let first = elements.first().and_then(|e| e.first());
        let last = elements.last().and_then(|e| e.last());
        let at = |n: &usize| positions[*n];
        let elements = match (endless, first, last) {
            (true, Some(first), Some(last)) => vec![vec![at(first), at(last)]],
            _ => elements
                .iter()
                .map(|e| e.iter().map(at).collect())
                .collect(),
        };
        Chain {
            closed: elements.len() > 1 && first == last,
            endless,
            held: [-1.0, 1.0],
            elements,
        }
    }

    /// The smooth chain through nodes in walking order, of whose positions `at` are the present ones and `knots` those that the
    /// parameter is measured along. From one node to the next it is the blend of two parabolas: that through both and the
    /// node before fades out, that through both and the node behind fades in.
    pub fn smooth(at: &[Point], knots: &[Point], closed: bool) -> Self {
        let last = at.len() - 1;
        let way = |k: usize| norm(minus(knots[k + 1], knots[k]));
        // Around a closed chain the first node comes again at the end.
        let before = |k: usize| match k {
            0 if closed => Some((at[last - 1], way(last - 1))),
            0 => None,
            _ => Some((at[k - 1], way(k - 1))),
        };
        let behind = |k: usize| match k + 2 {
            far if far <= last => Some((at[far], way(k + 1))),
            _ if closed => Some((at[1], way(0))),
            _ => None,
        };
        let piece = |k: usize| {
            let (b, c, h) = (at[k], at[k + 1], way(k));
            let early = before(k).map(|(a, way)| [(-way, a), (0.0, b), (h, c)]);
            let late = behind(k).map(|(d, way)| [(0.0, b), (h, c), (h + way, d)]);
            let place = |part: f64| {
                let s = part * h;
                match (early, late) {
                    (Some(early), Some(late)) => {
                        let (one, other) = (newton(&early, s), newton(&late, s));
                        [0, 1].map(|x| (1.0 - part) * one[x] + part * other[x])
                    }
                    (Some(only), None) | (None, Some(only)) => newton(&only, s),
                    (None, None) => [0, 1].map(|x| (1.0 - part) * b[x] + part * c[x]),
                }
            };
            [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(place).to_vec()
        };
        Chain {
            elements: (0..last).map(piece).collect(),
            closed,
            endless: false,
            held: [-1.0, 1.0],
        }
    }

    /// A chain of elements whose neighbours share their end.
    pub fn through(elements: Vec<Vec<Point>>) -> Self {
        Chain {
            elements,
            closed: false,
            endless: false,
            held: [-1.0, 1.0],
        }
    }

    /// The chain with its first and its last element as long as these parts of ξ on the same curve.
    pub fn extended(mut self, [before, behind]: [f64; 2]) -> Self {
        let last = self.elements.len() - 1;
        self.held = match last {
            0 => [before, -behind].map(|half| half / (2.0 + before + behind)),
            _ => [before / (2.0 + before), -behind / (2.0 + behind)],
        };
        self.held = [self.held[0] - 1.0, self.held[1] + 1.0];
        for (k, element) in self.elements.iter_mut().enumerate() {
            let start = if k == 0 { -1.0 - before } else { -1.0 };
            let end = if k == last { 1.0 + behind } else { 1.0 };
            let m = element.len();
            let xi = |i: usize| start + (end - start) * i as f64 / (m - 1) as f64;
            if before + behind > 0.0 {
                *element = (0..m).map(|i| sum(element, &shape(m, xi(i)).0)).collect();
            }
        }
        self
    }

    /// Whether only a node that is pressed is over the chain there.
    pub fn only_holds(&self, place: Place) -> bool {
        place.element == 0 && place.xi < self.held[0]
            || place.element + 1 == self.elements.len() && place.xi > self.held[1]
    }

    /// Number of elements.
    pub fn count(&self) -> usize {
        self.elements.len()
    }

    /// Position and dx/dξ.
    pub fn at(&self, place: Place) -> (Point, Point) {
        let nodes = &self.elements[place.element];
        let (n, d) = shape(nodes.len(), place.xi);
        (sum(nodes, &n), sum(nodes, &d))
    }

    /// Outward normal and tangent.
    pub fn frame(&self, place: Place) -> (Point, Point) {
        let t = unit(self.at(place).1);
        ([t[1], -t[0]], t)
    }

    /// All points of the chain that may be the closest to `p`.
    pub fn sites(&self, p: Point) -> Vec<Site> {
        let site = |at: At, place: Place| {
            let foot = self.at(place).0;
            let distance = norm(minus(p, foot));
            Site { foot, distance, at }
        };
        if self.endless {
            let place = self.on_line(p);
            return vec![site(At::Inside(place), place)];
        }
        let mut found = Vec::new();
        let count = self.elements.len();
        for element in 0..count {
            let insides = self.stationary(element, p);
            found.extend(insides.into_iter().map(|xi| {
                let place = Place { element, xi };
                site(At::Inside(place), place)
            }));
            let end = Place { element, xi: 1.0 };
            let next = Place {
                element: (element + 1) % count,
                xi: -1.0,
            };
            let border = self.closed || element + 1 < count;
            let at = if border {
                At::Border(end, next)
            } else {
                At::End(end)
            };
            found.push(site(at, end));
        }
        if !self.closed {
            let start = Place {
                element: 0,
                xi: -1.0,
            };
            found.push(site(At::End(start), start));
        }
        found
    }

    /// The closest point of all, and on which side of it `p` lies.
    pub fn see(&self, p: Point) -> Seen {
        let sites = self.sites(p).into_iter();
        let closer = |a: Site, b: Site| if b.distance < a.distance { b } else { a };
        // A chain has an element, and with it an end or a border.
        let site = sites.reduce(closer).expect("a chain has elements");
        let to = minus(p, site.foot);
        let normal = match site.at {
            At::Inside(place) => self.frame(place).0,
            At::Border(one, other) => {
                let (a, b) = (self.frame(one).0, self.frame(other).0);
                [a[0] + b[0], a[1] + b[1]]
            }
            At::End(place) => {
                let (n, t) = self.frame(place);
                let beyond = dot(to, t) * place.xi;
                if beyond > 0.0 {
                    return Seen::Beyond(site, beyond);
                }
                n
            }
        };
        let inside = dot(to, normal) < 0.0;
        let gap = if inside {
            -site.distance
        } else {
            site.distance
        };
        Seen::Over(site, gap)
    }

    /// Length of the chain from one place to another, positive along the walk; the shorter way round a closed one.
    pub fn length(&self, from: Place, to: Place) -> f64 {
        if from.element == to.element {
            return self.part(from.element, from.xi, to.xi);
        }
        let (low, high, sign) = if from.element < to.element {
            (from, to, 1.0)
        } else {
            (to, from, -1.0)
        };
        let between = low.element + 1..high.element;
        let open = self.part(low.element, low.xi, 1.0)
            + between.map(|e| self.part(e, -1.0, 1.0)).sum::<f64>()
            + self.part(high.element, -1.0, high.xi);
        let other = if self.closed {
            open - (0..self.count())
                .map(|e| self.part(e, -1.0, 1.0))
                .sum::<f64>()
        } else {
            f64::INFINITY
        };
        sign * if other.abs() < open { other } else { open }
    }

    /// Length of a part of an element.
    fn part(&self, element: usize, from: f64, to: f64) -> f64 {
        let step = (to - from) / PANELS as f64;
        let root = 0.6_f64.sqrt();
        let speed = |xi: f64| norm(self.at(Place { element, xi }).1);
        let panel = |k: usize| {
            let middle = from + (k as f64 + 0.5) * step;
            let side = 0.5 * step * root;
            5.0 * (speed(middle - side) + speed(middle + side)) + 8.0 * speed(middle)
        };
        (0..PANELS).map(panel).sum::<f64>() * step / 18.0
    }

    /// The coordinate of the foot on the endless line.
    fn on_line(&self, p: Point) -> Place {
        let (middle, half) = self.at(Place {
            element: 0,
            xi: 0.0,
        });
        let xi = dot(minus(p, middle), half) / dot(half, half);
        Place { element: 0, xi }
    }

    /// All ξ inside an element where the distance to `p` has a minimum.
    fn stationary(&self, element: usize, p: Point) -> Vec<f64> {
        let nodes = &self.elements[element];
        let falls = |n: &[f64; MOST], d: &[f64; MOST]| dot(minus(p, sum(nodes, n)), sum(nodes, d));
        let table = table(nodes.len());
        let values: Vec<f64> = table.iter().map(|(_, n, d)| falls(n, d)).collect();
        let mut found = Vec::new();
        for k in 0..SAMPLES {
            if !(values[k] > 0.0 && values[k + 1] <= 0.0) {
                continue;
            }
            let (mut low, mut high) = (table[k].0, table[k + 1].0);
            loop {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    break;
                }
                let (n, d) = shape(nodes.len(), middle);
                if falls(&n, &d) > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            if high < 1.0 {
                found.push(high);
            }
        }
        found
    }
}

/// The parabola through three points at given parameters, by divided differences.
fn newton(points: &[(f64, Point); 3], s: f64) -> Point {
    let [(p, a), (q, b), (r, c)] = *points;
    [0, 1].map(|x| {
        let (first, second) = ((b[x] - a[x]) / (q - p), (c[x] - b[x]) / (r - q));
        a[x] + (s - p) * (first + (s - q) * (second - first) / (r - p))
    })
}

/// Shape functions of m nodes at equal steps, and their derivatives.
pub fn shape(m: usize, xi: f64) -> ([f64; MOST], [f64; MOST]) {
    let node = |i: usize| 2.0 * i as f64 / (m - 1) as f64 - 1.0;
    let (mut n, mut d) = ([0.0; MOST], [0.0; MOST]);
    for i in 0..m {
        let (mut value, mut slope) = (1.0, 0.0);
        for j in (0..m).filter(|&j| j != i) {
            let apart = node(i) - node(j);
            slope = slope * (xi - node(j)) / apart + value / apart;
            value *= (xi - node(j)) / apart;
        }
        (n[i], d[i]) = (value, slope);
    }
    (n, d)
}

type Sample = (f64, [f64; MOST], [f64; MOST]);

/// The shape functions of m nodes at all samples.
fn table(m: usize) -> &'static [Sample] {
    static TABLES: [OnceLock<Vec<Sample>>; MOST + 1] = [const { OnceLock::new() }; MOST + 1];
    let sample = |k: usize| {
        let xi = 2.0 * k as f64 / SAMPLES as f64 - 1.0;
        let (n, d) = shape(m, xi);
        (xi, n, d)
    };
    TABLES[m].get_or_init(|| (0..=SAMPLES).map(sample).collect())
}

fn sum(nodes: &[Point], weights: &[f64; MOST]) -> Point {
    let mut total = [0.0; 2];
    for (node, w) in nodes.iter().zip(weights) {
        total[0] += w * node[0];
        total[1] += w * node[1];
    }
    total
}

pub fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The part of a × b across the plane.
pub fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub fn norm(a: Point) -> f64 {
    a[0].hypot(a[1])
}

fn unit(a: Point) -> Point {
    let size = norm(a);
    [a[0] / size, a[1] / size]
}
